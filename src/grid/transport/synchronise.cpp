#include "grid/transport/synchronise.hpp"

#include "grid/transport/apic.hpp"

#include <algorithm>

namespace treacle::grid {

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
            flow::carry_rate(rate, before, of.first, carried);
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

} // namespace treacle::grid
