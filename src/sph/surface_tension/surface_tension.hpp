#pragma once
#include "sph/model/domain.hpp"
#include "sph/surface_tension/surface_curvature.hpp"

#include <optional>

namespace treacle::sph {

// (S4t) Surface tension of the liquids against air, as accelerations before the pressure solve. Two models:
//     curvature   F_i = -V0 sigma k_i delta_i n_i (1 + k_i t / (2 (D-1)))   Morris 2000; k, delta, n, t: surface_curvature.hpp
//     cohesion    F_ij = -A V0^2 W_ij x_ij                     Becker & Teschner 2007, A = sigma / cohesion_energy()
// and with both, since what draws particles inwards also lets them pair up,
//     F_ij = s m sigma / (rho0 d^2) (1 - r/c) x_ij/r   for r < c, closer than in any order
// and, with curvature, what damps these pairs' motion along x_ij, m (sigma / (rho0 d^3))^1/2 (u_j - u_i).x_ij x_ij / r^2.
// Pair forces keep linear and angular momentum to round-off. So does the curvature model as long as the surface touches
// nothing: what its forces add up to, which is an error of k and N, is taken off them in proportion to |N|. Where a
// surface ends at solids, or on inlets, the liquid hangs on them by it, and nothing is taken off.
class SurfaceTension {
public:
    // tension: sigma [N/m] > 0, for a model other than none.
    SurfaceTension(LiquidParticles& liquid, const SphOptions& options, const Constants& constants,
        const DomainBox& domain, double tension);

    // Collective: u += dt a for the owned particles. Writes the field acceleration.
    void accelerate(const StepContext& parts, double dt);

private:
    double tension_;
    bool conserves_torque_; // no axis is periodic: torques have a meaning
    double cohesion_ = 0;   // A [N/m^(D+2)], sigma in N/m
    std::optional<SurfaceCurvature> curvature_;
};

// Largest step that resolves the shortest capillary waves, sqrt(rho0 d^3 / (4 pi sigma)) (Brackbill et al. 1992), of the
// lightest liquid, and a share of it with cohesion; 1e300 without surface tension [s].
double capillary_step_limit(const SurfaceTensionOptions& options, const Constants& constants, double tension);

} // namespace treacle::sph
