#pragma once
#include "kokkos/types.hpp"

namespace treacle::sph {

// (IS1c) Gradients of pressures that are exact where velocities are linear: B_i grad W_ij in place of grad W_ij, for kernels.
// Without fields it changes nothing.
struct GradientCorrection {
    Array3 diagonal, off_diagonal; // [particles][3] B: xx, yy, zz; xy, xz, yz
    Array<double> weight;          // [particles] of owned ones: how far M is inverted, 0 to 1
    Array3 normal;                 // [solids][3] unit, out of the solid

    // Factor on what solids add: a pressure that is the same everywhere then moves no first layer of liquid where it has come to
    // rest, 0.42 spacings off a plane wall (1.24 for the cubic spline in 2D, 1.25 in 3D).
    static constexpr double wall_factor = 1.25;

    KOKKOS_INLINE_FUNCTION bool exists() const { return diagonal.size() > 0; }
    // out = B_i g
    KOKKOS_INLINE_FUNCTION void times(int i, const double g[3], double out[3]) const {
        out[0] = diagonal(i, 0) * g[0] + off_diagonal(i, 0) * g[1] + off_diagonal(i, 1) * g[2];
        out[1] = off_diagonal(i, 0) * g[0] + diagonal(i, 1) * g[1] + off_diagonal(i, 2) * g[2];
        out[2] = off_diagonal(i, 1) * g[0] + off_diagonal(i, 2) * g[1] + diagonal(i, 2) * g[2];
    }
    // The gradient of particle i towards solid particle s, from that of the kernel: along the solid's normal, so that its
    // roughness does not hold back what slides along it; as it is where nothing is corrected, as of what solids squeeze out.
    KOKKOS_INLINE_FUNCTION void towards_solid(int i, int s, const double g[3], double out[3]) const {
        if (!exists()) {
            for (int k = 0; k < 3; ++k) out[k] = g[k];
            return;
        }
        times(i, g, out);
        double along = 0;
        for (int k = 0; k < 3; ++k) along += normal(s, k) * out[k];
        for (int k = 0; k < 3; ++k) out[k] = g[k] + weight(i) * (wall_factor * along * normal(s, k) - g[k]);
    }
};

} // namespace treacle::sph
