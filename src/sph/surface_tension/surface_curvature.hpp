#pragma once
#include "sph/model/step_context.hpp"

namespace treacle::sph {

// Length of row i of v [rows][3], in v's unit; for kernels.
KOKKOS_INLINE_FUNCTION double row_length(const Array3& v, int i) {
    return math::sqrt(v(i, 0) * v(i, 0) + v(i, 1) * v(i, 1) + v(i, 2) * v(i, 2));
}

// Surface of the liquid and its curvature (Morris 2000, with averages in the place of a wider kernel):
//     N_i = sum_j V0 grad W                    into the liquid; beside solids without its part along sum_s V_s grad W,
//                                              so that the surface meets walls at a right angle
//     N_i <- sum_j W N_j / sum_j W             `passes` times, the particle itself among the j
//     k_i = (D-1) sum_j w (n_i - n_j).x_ij / sum_j w |x_ij - n_i (n_i.x_ij)|^2,   n = -N/|N|, w = |N_j| |W'|/r
//     k_i <- sum_j W |N_j| k_j / sum_j W |N_j|
//     k_i <- k_i / (1 + k_i t / (D-1))         from the mean depth t of the N to the surface
//     delta_i = |N'_i| / sum_j V0 |N'_j| W_s   N' after the first pass, W_s = c (1 - (s/a)^2)^2 of the distance s along the
//                                              surface, normalised in D-1 dimensions, a = 0.8 h, over j with n_i.n_j > 0
// A sphere has k = 2/R, a disc 1/R. V0 delta adds up to the area of any part of the surface, however its particles lie. Particles
// with |N| h below 0.1 are none of the surface: N = 0, k = 0, delta = 0.
class SurfaceCurvature {
public:
    SurfaceCurvature(LiquidParticles& liquid, const SphOptions& options, const Constants& constants);

    // Collective: of the owned particles.
    void measure(const StepContext& parts);

    const Array3& normal(const LiquidParticles& liquid) const;           // N [1/m]
    const Array<double>& curvature(const LiquidParticles& liquid) const; // k [1/m]
    const Array<double>& delta(const LiquidParticles& liquid) const;     // [1/m]
    // t / (2 (D-1)), t the mean depth of a flat surface's delta [m]. A force that acts at the depth t holds Laplace's pressure
    // as it is, and drives the second mode of a drop by a factor 1 - 2 t/R too little: a quarter of that is made up for.
    double lift() const { return lift_; }

private:
    int normal_[2], curvature_[2]; // fields: each smoothing goes from the one to the other
    int strength_ = 0, delta_ = 0; // fields: |N'|, and delta
    int last_normal_ = 0, last_curvature_ = 0;
    double depth_ = 0, lift_ = 0; // [m]
};

} // namespace treacle::sph
