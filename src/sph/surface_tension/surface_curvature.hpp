#pragma once
#include "sph/model/step_context.hpp"

namespace treacle::sph {

// Surface of the liquid and its curvature (Morris 2000, with averages in the place of a wider kernel):
//     N_i = sum_j V0 grad W                    into the liquid; beside solids without its part along sum_s V_s grad W,
//                                              so that the surface meets walls at a right angle
//     N_i <- sum_j W N_j / sum_j W             `passes` times, the particle itself among the j
//     k_i = (D-1) sum_j w (n_i - n_j).x_ij / sum_j w |x_ij - n_i (n_i.x_ij)|^2,   n = -N/|N|, w = |N_j| |W'|/r
//     k_i <- sum_j W |N_j| k_j / sum_j W |N_j|
//     k_i <- k_i / (1 + k_i t / (D-1))         from the mean depth t of the N to the surface
// A sphere has k = 2/R, a disc 1/R. Particles with |N| h below 0.1 are none of the surface: N = 0, k = 0.
class SurfaceCurvature {
public:
    SurfaceCurvature(LiquidParticles& liquid, const SphOptions& options, const Constants& constants);

    // Collective: of the owned particles.
    void measure(const StepContext& parts);

    const Array3& normal(const LiquidParticles& liquid) const;           // N [1/m]
    const Array<double>& curvature(const LiquidParticles& liquid) const; // k [1/m]
    // Sum of |N| d across a surface of curvature k: the N of a flat one, which spread to a mean depth t, crowd together
    // towards the centre of a curved one.
    double rise() const { return rise_; }   // of a flat one
    double depth() const { return depth_; } // t [m]; the other is rise (1 + k t)

private:
    int normal_[2], curvature_[2]; // fields: each smoothing goes from the one to the other
    int last_normal_ = 0, last_curvature_ = 0;
    double rise_ = 0, depth_ = 0;
};

} // namespace treacle::sph
