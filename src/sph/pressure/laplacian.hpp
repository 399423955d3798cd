#pragma once
#include "sph/model/neighbourhood.hpp"

namespace treacle::sph {

// The pair coefficient of the SPH Laplacian, a_ij = -(V_i + V_j) x.grad W / (r^2 + 0.01 h^2) > 0 [1/m2].
// Symmetric bit for bit: r2 and the sum of the volumes do not depend on the order, and pairs of liquid particles are
// all computed as SimdDouble.
template <class Kernel>
struct LaplacianWeight {
    Kernel kernel;
    double soft;          // 0.01 h^2 [m2]
    Array<double> volume; // [particles] [m^D]

    // a_ij [1/m2] from V_i + V_j [m^D], r^2 [m2] and r [m].
    template <Number T>
    KOKKOS_INLINE_FUNCTION T weight(T volumes, T r2, T r) const {
        return weight_of(volumes, r2, kernel.radial(r));
    }
    // With W'(r) r of the kernel.
    template <Number T>
    KOKKOS_INLINE_FUNCTION T weight_of(T volumes, T r2, T radial) const {
        return -volumes * (radial * inverse(r2 + soft));
    }
};

// Weight of the liquid's volumes, whose field it shares.
template <class Kernel>
LaplacianWeight<Kernel> laplacian_weight(
    const Kernel& kernel, const Constants& constants, const LiquidParticles& liquid) {
    return {kernel, 0.01 * constants.support * constants.support, liquid.volume()};
}

} // namespace treacle::sph
