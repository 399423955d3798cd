#include "grid/transport/synchronise.hpp"

#include "grid/transport/apic.hpp"

#include <algorithm>

namespace treacle::grid {

namespace {
// Twice the rate less that of before, or nothing where it has jumped.
KOKKOS_INLINE_FUNCTION void carry_rate(const double rate[3], const double before[3], bool first, double out[3]) {
    double jump = 0, size = 0;
    for (int k = 0; k < 3; ++k) {
        const double from = first ? rate[k] : before[k];
        jump += (rate[k] - from) * (rate[k] - from);
        size += rate[k] * rate[k] + from * from;
        out[k] = 2 * rate[k] - from;
    }
    if (jump < smooth_fraction * size) return;
    for (int k = 0; k < 3; ++k) out[k] = 0;
}
} // namespace

void end_velocities(const MacGrid& grid, const CellBox& window, const FaceField& change, const StepTimes& times,
    const GridParticles& particles) {
    const FaceSampler sampler(grid, window, change);
    const auto x = particles.position(), u = particles.velocity();
    const auto acceleration = particles.acceleration(), end = particles.end_velocity();
    const StepTimes of = times;
    Kokkos::parallel_for(
        "treacle::end_velocities", particles.store.owned(), KOKKOS_LAMBDA(int i) {
            const double at[3] = {x(i, 0), x(i, 1), x(i, 2)};
            const double before[3] = {acceleration(i, 0), acceleration(i, 1), acceleration(i, 2)};
            double rate[3], carried[3];
            sampler.velocity(at, rate);
            for (int k = 0; k < 3; ++k) rate[k] /= of.kick;
            carry_rate(rate, before, of.first, carried);
            for (int k = 0; k < 3; ++k) {
                acceleration(i, k) = rate[k];
                end(i, k) = u(i, k) + 0.5 * of.drift * carried[k];
            }
        });
}

void begin_velocities(const GridParticles& particles, int begin) {
    const auto u = particles.velocity(), acceleration = particles.acceleration(), end = particles.end_velocity();
    Kokkos::parallel_for(
        "treacle::begin_velocities", Kokkos::RangePolicy<>(begin, std::max(begin, particles.store.owned())),
        KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) {
                end(i, k) = u(i, k);
                acceleration(i, k) = 0;
            }
        });
}

void EndMotion::start(Middle middle) {
    middle_ = std::move(middle);
    end_ = middle_.liquid;
    lead_.assign(middle_.velocities.size(), 0.0);
    rate_ = {{}, lead_, lead_};
}

namespace {
std::vector<double> rate_of(std::span<const double> now, std::span<const double> before, double time) {
    std::vector<double> out(now.size());
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = (now[k] - before[k]) / time;
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

void EndMotion::record(Middle middle, const StepTimes& times) {
    Middle rate;
    const auto liquid = rate_of(middle.liquid, middle_.liquid, times.kick);
    std::copy(liquid.begin(), liquid.end(), rate.liquid.begin());
    rate.momenta = rate_of(middle.momenta, middle_.momenta, times.kick);
    rate.velocities = rate_of(middle.velocities, middle_.velocities, times.kick);
    if (times.first) rate_ = rate;
    end_ = middle.liquid;
    std::ranges::fill(lead_, 0.0);
    for (const std::size_t half : {0u, 3u}) {
        std::array<double, 2> sums{0, 0};
        add_squares(rate.liquid, rate_.liquid, half, sums);
        add_squares(rate.momenta, rate_.momenta, half, sums);
        if (!(sums[0] < smooth_fraction * sums[1])) continue;
        add_lead(rate.liquid, rate_.liquid, half, times.drift, end_);
        add_lead(rate.velocities, rate_.velocities, half, times.drift, lead_);
    }
    middle_ = std::move(middle);
    rate_ = std::move(rate);
}

std::vector<double> EndMotion::state() const {
    std::vector<double> out(end_.begin(), end_.end());
    for (const auto* part : {&middle_, &rate_}) {
        out.insert(out.end(), part->liquid.begin(), part->liquid.end());
        out.insert(out.end(), part->momenta.begin(), part->momenta.end());
        out.insert(out.end(), part->velocities.begin(), part->velocities.end());
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
        part->momenta.resize(6 * bodies);
        part->velocities.resize(6 * bodies);
        take(part->liquid);
        take(part->momenta);
        take(part->velocities);
    }
    lead_.assign(6 * bodies, 0.0);
}

} // namespace treacle::grid
