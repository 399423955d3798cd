#include "flow/end_motion.hpp"

#include <algorithm>

namespace treacle::flow {

void EndMotion::start(Middle middle) {
    middle_ = std::move(middle);
    end_ = middle_.liquid;
    lead_.assign(middle_.bodies.size(), 0.0);
    rate_ = {{}, lead_};
}

void EndMotion::start(Middle middle, Middle rate) {
    start(std::move(middle));
    rate_ = std::move(rate);
}

namespace {
std::vector<double> difference(std::span<const double> a, std::span<const double> b) {
    std::vector<double> out(a.size());
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = a[k] - b[k];
    return out;
}

std::vector<double> rate_of(std::span<const double> now, std::span<const double> before, double time) {
    auto out = difference(now, before);
    for (double& one : out) one /= time;
    return out;
}

// The linear or the angular ones of the numbers of liquid or bodies.
struct Part {
    std::size_t each, first, end; // numbers of the liquid or of a body, those that count

    template <class Visit>
    void visit(std::size_t size, const Visit& visit_number) const {
        for (std::size_t at = 0; at + each <= size; at += each) {
            for (std::size_t k = at + first; k < at + end; ++k) visit_number(k);
        }
    }
};
constexpr std::array<Part, 2> of_liquid{Part{6, 0, 3}, Part{6, 3, 6}};
constexpr std::array<Part, 2> of_bodies{
    Part{EndMotion::body_numbers, 0, 3}, Part{EndMotion::body_numbers, 3, EndMotion::body_numbers}};
constexpr Part of_orbits{EndMotion::body_numbers, 6, EndMotion::body_numbers};

// Sums |rate - before|^2 and |rate|^2 + |before|^2.
void add_squares(
    std::span<const double> rate, std::span<const double> before, const Part& part, std::array<double, 2>& sums) {
    part.visit(rate.size(), [&](std::size_t k) {
        sums[0] += (rate[k] - before[k]) * (rate[k] - before[k]);
        sums[1] += rate[k] * rate[k] + before[k] * before[k];
    });
}

void add_lead(std::span<const double> rate, std::span<const double> before, const Part& part, double drift,
    std::span<double> out) {
    part.visit(rate.size(), [&](std::size_t k) { out[k] += 0.5 * drift * (2 * rate[k] - before[k]); });
}
} // namespace

// Moments of the weights are led with the momenta where other moments are not: weights act on nothing else.
void EndMotion::record(Middle middle, const Known& known, const StepTimes& times) {
    Middle rate;
    const auto liquid = rate_of(middle.liquid, middle_.liquid, times.kick);
    std::copy(liquid.begin(), liquid.end(), rate.liquid.begin());
    rate.bodies = rate_of(difference(middle.bodies, known.impacts), middle_.bodies, times.kick);
    if (times.first) rate_ = rate;
    end_ = middle.liquid;
    std::ranges::fill(lead_, 0.0);
    std::array<bool, 2> leads{};
    for (std::size_t half = 0; half < of_liquid.size(); ++half) {
        std::array<double, 2> sums{0, 0};
        add_squares(rate.liquid, rate_.liquid, of_liquid[half], sums);
        add_squares(rate.bodies, rate_.bodies, of_bodies[half], sums);
        leads[half] = sums[0] < smooth_fraction * sums[1];
        if (!leads[half]) continue;
        add_lead(rate.liquid, rate_.liquid, of_liquid[half], times.drift, end_);
        add_lead(rate.bodies, rate_.bodies, of_bodies[half], times.drift, lead_);
    }
    if (leads[0] && !leads[1]) add_lead(known.weights, known.weights, of_orbits, times.drift, lead_);
    middle_ = std::move(middle);
    rate_ = std::move(rate);
}

std::vector<double> EndMotion::state() const {
    std::vector<double> out(end_.begin(), end_.end());
    for (const auto* part : {&middle_, &rate_}) {
        out.insert(out.end(), part->liquid.begin(), part->liquid.end());
        out.insert(out.end(), part->bodies.begin(), part->bodies.end());
    }
    return out;
}

void EndMotion::restore(std::span<const double> state, std::size_t bodies) {
    const auto take = [&](std::span<double> to) {
        std::copy_n(state.begin(), to.size(), to.begin());
        state = state.subspan(to.size());
    };
    take(end_);
    for (auto* part : {&middle_, &rate_}) {
        part->bodies.resize(body_numbers * bodies);
        take(part->liquid);
        take(part->bodies);
    }
    lead_.assign(body_numbers * bodies, 0.0);
}

} // namespace treacle::flow
