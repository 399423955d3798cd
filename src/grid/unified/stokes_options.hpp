#pragma once
#include "grid/mac/solver_options.hpp"

namespace treacle::grid {

// Order of pressure and viscosity in a step.
enum class StokesSolve {
    automatic, // together where viscosity spreads velocities by a third of a cell or more in the step, split elsewhere
    split,     // the pressure, the viscosity, and the pressure again, one after the other
    together   // one system of both
};

// Options of the block `stokes`.
struct StokesOptions {
    StokesSolve solve = StokesSolve::automatic;
    double residual = 1e-8;   // relative
    int max_iterations = 300; // of one solve

    void declare(Declaration& d); // keys of `stokes`
};

} // namespace treacle::grid
