#pragma once
#include "grid/mac/solver_options.hpp"

namespace treacle::grid {

struct ViscosityOptions {
    Preconditioner preconditioner = Preconditioner::multilevel;
    double residual = 1e-8; // relative
    int max_iterations = 2000;
    double least_wet = 1e-3;    // share of a cube below which liquid is none: slivers cost iterations
    double least_gap = 0.01;    // share of a stress' cube outside of solids, below which the faces beside it are held
    double normal_layer = 0.02; // widths, of the layer of liquid by which slip surfaces resist flow across them

    void declare(Declaration& d);
};

} // namespace treacle::grid
