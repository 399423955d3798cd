#pragma once
#include "grid/options.hpp"
#include "sph/model/options.hpp"

namespace treacle::app {

// Discretisation of the liquid.
enum class MethodKind {
    sph, // particles alone: hybrid incompressible SPH (dissertation, chapters 2 to 4)
    grid // particles carry what a MAC grid moves (chapter 5)
};

// The block `method` of a scene: which one, and its options. Those of SPH stand in the block itself, those of the grid
// in a block of their own.
struct MethodOptions : sph::SphOptions {
    MethodKind kind = MethodKind::sph;
    grid::GridOptions grid;
    std::string where;

    // Keys of the block `method`.
    void declare(Declaration& d);
};

} // namespace treacle::app
