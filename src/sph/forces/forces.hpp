#pragma once
#include "base/text/vec3.hpp"
#include "flow/viscosity_model.hpp"
#include "sph/model/moment_reference_points.hpp"
#include "sph/model/step_context.hpp"

#include <vector>

namespace treacle::sph {

// Explicit accelerations before the pressure solve.
struct ForceOptions {
    Vec3 gravity{0, 0, 0};      // [m/s2]
    double artificial = 0;      // alpha h c of Monaghan 1992 [m2/s]
    double viscosity = 0;       // dynamic [Pa s]; of several liquids: as of one of the first one's density that limits
                                // the step as much (largest_kinematic_viscosity)
    double surface_tension = 0; // of all liquids against air [N/m]
    std::vector<double> friction;               // per body: 0 free slip, 1 no slip
    std::vector<double> skin_friction;          // per body: c_f
    std::vector<double> slip_length;            // per body [m]; 0: by `friction`
    bool by_particle = false;                   // viscosities are those of the particles, not of their liquids
    std::vector<flow::ViscosityModel> rheology; // per liquid; empty: no viscosity depends on the shear rate
};

// Force [N] and torque [N m] on each body, 6 numbers a body; the torque about the body's load point.
using BodyLoads = std::vector<double>;

// (S4) Gravity, Monaghan's artificial viscosity, and the physical viscosity in the pairwise form of Monaghan &
// Cleary, 2 (D+2) mu (v.x) grad W / (rho0^2 r^2), which conserves linear and angular momentum; then
// u* = u + dt a for the owned particles. Explicit: stable for dt <= viscous_step_limit(). Returns this rank's share
// of the viscous forces on the bodies, equal and opposite; none when `points` are not given. Liquids that differ act on
// each other by the harmonic means of their viscosities and, in the artificial one, of their densities.
BodyLoads apply_forces(
    const StepContext& parts, const ForceOptions& forces, double dt, const MomentReferencePoints& points = 0);

// Largest step of the explicit viscosity, 0.125 h^2 rho / mu (Morris et al. 1997) [s].
double viscous_step_limit(const Constants& constants, double viscosity);
// The same of whatever `integration` and `form` make explicit: forms with gradients 0.0125 h^2 rho / mu (Andrade et al.
// 2014). 1e300 for an implicit one.
double viscous_step_limit(const ViscosityOptions& options, const Constants& constants, double viscosity);

// p / rho^2 of the owned particles, for apply_pressure; the ghosts' must be gathered in between.
void compute_pressure_over_density2(const Constants& constants, LiquidParticles& liquid);

// (S8) Acceleration by pressure, -sum_j m (p_i/rho_i^2 + p_j/rho_j^2) grad W - rho0 sum_s V_s p_i/rho_i^2
// grad W (Akinci et al. 2012; of several liquids: ImmiscibleLiquids, README), added to the velocities; equal and opposite on the bodies, of which this
// rank's share is returned. With corrected gradients the accelerations are those that Iisph::solve has left.
BodyLoads apply_pressure(const StepContext& parts, const MomentReferencePoints& points, double dt);

// XSPH (Monaghan 1989): writes epsilon sum_j (V_i + V_j)/2 (u_j - u_i) W to the acceleration field as a velocity
// correction [m/s]. Ghost velocities must be current.
void compute_xsph(const SphOptions& options, const Constants& constants, LiquidParticles& liquid,
    const SolidParticles& solid, const Neighbourhood& neighbours);

} // namespace treacle::sph
