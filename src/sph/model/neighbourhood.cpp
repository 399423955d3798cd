#include "sph/model/neighbourhood.hpp"

namespace treacle::sph {

void pack_positions(LiquidParticles& liquid, const Array<double>& number) {
    const int n = liquid.store.total();
    reserve(liquid.packed_position, static_cast<std::size_t>(n));
    const auto x = liquid.position();
    const auto to = liquid.packed_position;
    Kokkos::parallel_for(
        "treacle::pack_positions", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) to(i, k) = x(i, k);
            to(i, 3) = number(i);
        });
}

void pack_velocities(LiquidParticles& liquid) {
    const int n = liquid.store.total();
    reserve(liquid.motion, static_cast<std::size_t>(n));
    const auto u = liquid.velocity();
    const auto p = liquid.pressure();
    const auto to = liquid.motion;
    Kokkos::parallel_for(
        "treacle::pack_velocities", n, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) to(i, k) = u(i, k);
            to(i, 3) = p(i);
        });
}

} // namespace treacle::sph
