#pragma once
#include "grid/mac/solver_options.hpp"

namespace treacle::grid {

// Options of the block `viscosity`.
struct ViscosityOptions {
    Preconditioner preconditioner = Preconditioner::multilevel; // of the conjugate gradients
    double residual = 1e-8;                                     // relative
    int max_iterations = 2000;                                  // of one solve; beyond: SimulationError
    double min_liquid_fraction = 1e-3; // share of a cube below which liquid is none: slivers cost iterations
    double min_fluid_fraction =
        0.01; // share of a stress' cube outside of solids, below which the faces beside it are held
    double no_penetration_layer = 0.02; // widths, of the layer of liquid by which slip surfaces resist flow across them

    void declare(Declaration& d); // keys of `viscosity`
};

} // namespace treacle::grid
