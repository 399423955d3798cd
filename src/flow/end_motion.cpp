#include "flow/end_motion.hpp"

#include <algorithm>

namespace treacle::flow {

void EndMotion::start(Middle middle) {
    middle_ = std::move(middle);
    end_ = middle_.liquid;
    lead_.assign(middle_.bodies.size(), 0.0);
    rate_ = {{}, lead_};
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

// Sums |rate - before|^2 and |rate|^2 + |before|^2 of the linear or the angular halves.
void add_squares(
    std::span<const double> rate, std::span<const double> before, std::size_t half, std::array<double, 2>& sums) {
    for (std::size_t at = half; at + 3 <= rate.size(); at += 6) {
        for (std::size_t k = at; k < at + 3; ++k) {
            sums[0] += (rate[k] - before[k]) * (rate[k] - before[k]);
            sums[1] += rate[k] * rate[k] + before[k] * before[k];
        }
    }
}

void add_lead(std::span<const double> rate, std::span<const double> before, std::size_t half, double drift,
    std::span<double> out) {
    for (std::size_t at = half; at + 3 <= rate.size(); at += 6) {
        for (std::size_t k = at; k < at + 3; ++k) out[k] += 0.5 * drift * (2 * rate[k] - before[k]);
    }
}
} // namespace

void EndMotion::record(Middle middle, std::span<const double> impacts, const StepTimes& times) {
    Middle rate;
    const auto liquid = rate_of(middle.liquid, middle_.liquid, times.kick);
    std::copy(liquid.begin(), liquid.end(), rate.liquid.begin());
    rate.bodies = rate_of(difference(middle.bodies, impacts), middle_.bodies, times.kick);
    if (times.first) rate_ = rate;
    end_ = middle.liquid;
    std::ranges::fill(lead_, 0.0);
    for (const std::size_t half : {0u, 3u}) {
        std::array<double, 2> sums{0, 0};
        add_squares(rate.liquid, rate_.liquid, half, sums);
        add_squares(rate.bodies, rate_.bodies, half, sums);
        if (!(sums[0] < smooth_fraction * sums[1])) continue;
        add_lead(rate.liquid, rate_.liquid, half, times.drift, end_);
        add_lead(rate.bodies, rate_.bodies, half, times.drift, lead_);
    }
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
        part->bodies.resize(6 * bodies);
        take(part->liquid);
        take(part->bodies);
    }
    lead_.assign(6 * bodies, 0.0);
}

} // namespace treacle::flow
