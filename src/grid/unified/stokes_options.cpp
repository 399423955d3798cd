#include "grid/unified/stokes_options.hpp"

#include "base/options/options.hpp"

namespace treacle::grid {

void StokesOptions::declare(Declaration& d) {
    d.choice("solve", solve,
        {{"automatic", StokesSolve::automatic}, {"split", StokesSolve::split}, {"together", StokesSolve::together}},
        "Pressure and viscosity one after the other, or as one system (unsteady Stokes flow). One after the other, "
        "liquid and bodies that viscosity holds back give way too fast, up to twice, in steps in which it spreads "
        "velocities farther than the flow is wide. automatic: together in steps with eta dt / rho above dx^2 / 10, by "
        "the "
        "largest viscosity.");
    declare_residual(
        d, residual, "Relative residual at which the solve of both together ends, of momentum and mass at once.");
    d.integer("max_iterations", max_iterations, range_between(1, 100000),
        "Iterations after which the solve of both together ends; the step goes on where the residual is below 0.01, "
        "and is reported with it.");
}

} // namespace treacle::grid
