#pragma once
#include "grid/mac/solver_options.hpp"
#include "solve/multigrid/smoother.hpp"

namespace treacle::grid {

// Liquid under walls.
enum class Ceilings {
    separate, // liquid leaves walls above it where only a negative pressure would keep it there
    adhere    // no wall lets liquid go
};

// Options of the block `pressure`.
struct PressureOptions {
    Preconditioner preconditioner = Preconditioner::multilevel; // of the conjugate gradients
    solve::Smoother smoother = solve::default_smoother();       // of Preconditioner::multilevel
    double residual = 1e-8;                                     // relative
    int max_iterations = 1000;                                  // of one solve; beyond: SimulationError
    double min_theta = 1e-4;              // of a cell's centre from the surface, in widths (ghost fluid)
    double min_face_area_fraction = 0.01; // share of a face's area below which it is closed
    Ceilings ceilings = Ceilings::separate;

    void declare(Declaration& d); // keys of `pressure`
};

} // namespace treacle::grid
