#include "sph/forces/end_velocity.hpp"

#include <algorithm>

namespace treacle::sph {

void begin_velocities(const LiquidParticles& liquid, int begin, const Vec3& gravity) {
    const double g[3] = {gravity[0], gravity[1], gravity[2]};
    const auto u = liquid.velocity(), end = liquid.end_velocity(), rate = liquid.rate();
    Kokkos::parallel_for(
        "treacle::begin_velocities", Kokkos::RangePolicy<>(begin, std::max(begin, liquid.store.owned())),
        KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) {
                end(i, k) = u(i, k);
                rate(i, k) = g[k];
            }
        });
}

void note_velocities(const LiquidParticles& liquid) {
    const auto u = liquid.velocity(), end = liquid.end_velocity();
    Kokkos::parallel_for(
        "treacle::note_velocities", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) end(i, k) = u(i, k);
        });
}

void end_velocities(const LiquidParticles& liquid, const flow::StepTimes& times) {
    const auto u = liquid.velocity(), end = liquid.end_velocity(), rate = liquid.rate();
    const flow::StepTimes of = times;
    Kokkos::parallel_for(
        "treacle::end_velocities", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            double now[3], carried[3];
            const double before[3] = {rate(i, 0), rate(i, 1), rate(i, 2)};
            for (int k = 0; k < 3; ++k) now[k] = (u(i, k) - end(i, k)) / of.kick;
            flow::carry_rate(now, before, false, carried);
            for (int k = 0; k < 3; ++k) {
                rate(i, k) = now[k];
                end(i, k) = u(i, k) + 0.5 * of.drift * carried[k];
            }
        });
}

} // namespace treacle::sph
