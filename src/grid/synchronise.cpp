#include "grid/synchronise.hpp"

#include "grid/apic.hpp"

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
    if (jump < smooth_share * size) return;
    for (int k = 0; k < 3; ++k) out[k] = 0;
}
} // namespace

void end_velocities(const MacGrid& grid, const CellBox& window, const FaceField& change, const StepTimes& times,
                    const GridParticles& particles) {
    const FaceSampler sampler(grid, window, change);
    const auto x = particles.position(), u = particles.velocity();
    const auto acceleration = particles.acceleration(), end = particles.end_velocity();
    const StepTimes of = times;
    Kokkos::parallel_for("treacle::end_velocities", particles.store.owned(), KOKKOS_LAMBDA(int i) {
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
    Kokkos::parallel_for("treacle::begin_velocities", Kokkos::RangePolicy<>(begin, std::max(begin, particles.store.owned())),
                         KOKKOS_LAMBDA(int i) {
                             for (int k = 0; k < 3; ++k) {
                                 end(i, k) = u(i, k);
                                 acceleration(i, k) = 0;
                             }
                         });
}

void EndMomentum::record(const std::array<double, 6>& middle, const StepTimes& times) {
    for (std::size_t part = 0; part < 6 && times.kick > 0; part += 3) {
        double rate[3], carried[3];
        for (std::size_t k = 0; k < 3; ++k) rate[k] = (middle[part + k] - middle_[part + k]) / times.kick;
        carry_rate(rate, &rate_[part], times.first, carried);
        for (std::size_t k = 0; k < 3; ++k) {
            rate_[part + k] = rate[k];
            end_[part + k] = middle[part + k] + 0.5 * times.drift * carried[k];
        }
    }
    if (!(times.kick > 0)) end_ = middle;
    middle_ = middle;
}

std::vector<double> EndMomentum::state() const {
    std::vector<double> out;
    for (const auto* part : {&middle_, &rate_, &end_}) out.insert(out.end(), part->begin(), part->end());
    return out;
}

void EndMomentum::restore(std::span<const double> state) {
    auto* at = state.data();
    for (auto* part : {&middle_, &rate_, &end_}) {
        std::copy_n(at, 6, part->begin());
        at += 6;
    }
}

} // namespace treacle::grid
