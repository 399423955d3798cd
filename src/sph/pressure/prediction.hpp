#pragma once
#include "sph/model/step_context.hpp"

namespace treacle::sph {

// Numbers of particles by Role.
struct RoleCounts {
    std::int64_t poisson = 0;
    std::int64_t dirichlet = 0;
    std::int64_t separated = 0;
};

// Pressures of a last step to predict from; not so in the first step of a run.
enum class LastPressures { none, known };

// (S5) Predicted density rho* by the continuity equation with u* (Eq. 2.4), and (S6) the role of each owned
// particle by one projected Jacobi step from gamma p^t (Eq. 2.6), the solid term and the right-hand side of the
// pressure system -lap p = (rho* - rho0) / dt^2 (signs of chapter 3: a_ij > 0).
// With the response of bodies, the field `response` has the bodies' part of each row with p^t
// (rigid_coupling_term.hpp).
// Reads ghost velocities u*, densities and pressures p^t. Writes role, source (right-hand side), diagonal
// (sum_j a_ij + wall term), wall_term: what walls and ghosts add. With solids as unknowns the diagonal has their a_is
// too, and wall_term is left to SolidRows. Other rules than Eq. 2.6 and clamped sources: src/sph/theory.md.
// Returns this rank's counts.
RoleCounts predict(
    const StepContext& parts, LastPressures pressures, double dt, BodyCoupling coupling = BodyCoupling::weak);

// This rank's particles by their present roles.
RoleCounts count_roles(const LiquidParticles& liquid);

} // namespace treacle::sph
