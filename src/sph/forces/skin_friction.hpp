#pragma once
#include "sph/forces/forces.hpp"

namespace treacle::sph {

// Input of (S4s).
struct SkinFriction {
    const std::vector<double>& coefficients; // c_f per body
    const MomentReferencePoints& points;     // about which torques are taken
    double dt;                               // [s]
};

// (S4s) Turbulent skin friction of walls whose boundary layer is thinner than a particle: the shear stress
// c_f / 2 rho |v_t| v_t of the velocity v_t along the wall, relative to it (Whitham 1955 for dam breaks), on the wall
// area per volume at a particle, |sum_s V_s grad W| [1/m]. Implicit in v_t, so that no step is too large.
// Changes the velocities of the owned particles, and adds the opposite forces to the loads of the bodies.
void apply_skin_friction(const StepContext& parts, const SkinFriction& friction, BodyLoads& loads);

} // namespace treacle::sph
