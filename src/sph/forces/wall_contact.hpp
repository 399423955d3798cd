#pragma once
#include "sph/forces/forces.hpp"
#include "sph/model/step_context.hpp"

namespace treacle::sph {

// Input of (S8c).
struct WallStop {
    const MomentReferencePoints& points; // about which torques are taken
    double dt;                           // [s]
};

// (S8c) No liquid crosses a solid's surface within the step: where a particle over a solid particle would sink below
// the surface there, its velocity loses what leads it below, relative to the solid (inelastic contact). Pressures alone
// prevent penetration only as long as the particle comes to the one layer of solid particles in several steps. The
// impulses, over dt, are added with the opposite sign to the loads of the bodies, at the particle's place: linear and
// angular momentum stay. Returns how many owned particles were stopped.
std::int64_t stop_at_walls(const StepContext& parts, const WallStop& at, BodyLoads& loads);

// (S8c) The same of a shift of places [m/s] that particles move by besides their velocities; these stay, and so do the bodies.
void stop_shift_at_walls(const StepContext& parts, const WallStop& at, const Array3& shift);

} // namespace treacle::sph
