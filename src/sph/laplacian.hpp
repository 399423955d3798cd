#pragma once
#include "sph/neighbourhood.hpp"

namespace treacle::sph {

// The pair coefficient of the SPH Laplacian, a_ij = -(V_i + V_j) x.grad W / (r^2 + 0.01 h^2) > 0 [1/m2].
// Symmetric bit for bit: r2 and the sum of the volumes do not depend on the order.
template <class Kernel>
struct LaplacianWeight {
    Kernel kernel;
    double soft;
    Array<double> volume;

    KOKKOS_INLINE_FUNCTION double weight(double volumes, double r2, double r) const {
        return -volumes * (kernel.radial(r) / (r2 + soft));
    }
};

template <class Kernel>
LaplacianWeight<Kernel> laplacian_weight(const Kernel& kernel, const Constants& constants,
                                         const LiquidParticles& liquid) {
    return {kernel, 0.01 * constants.support * constants.support, liquid.volume()};
}

} // namespace treacle::sph
