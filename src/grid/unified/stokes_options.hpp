#pragma once
#include "grid/mac/solver_options.hpp"

namespace treacle::grid {

enum class StokesSolve {
    automatic, // together where viscosity spreads velocities by a third of a cell or more in the step, split elsewhere
    split,     // the pressure, the viscosity, and the pressure again, one after the other
    together   // one system of both
};

struct StokesOptions {
    StokesSolve solve = StokesSolve::automatic;
    double residual = 1e-8; // relative
    int max_iterations = 300;

    void declare(Declaration& d);
};

} // namespace treacle::grid
