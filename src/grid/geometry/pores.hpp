#pragma once
#include "grid/geometry/solids.hpp"

namespace treacle::grid {

// Pores: places without liquid, at most five fine nodes across, that liquid and solids enclose. Liquid that is torn leaves
// them. As air, with a pressure of 0, a pore would be a vacuum into which the liquid of a tank falls at (2 p / rho)^1/2;
// closed, it counts as liquid that is too sparse, which contracts (D).
class Pores {
public:
    // Collective. `distance` from the liquid at the fine nodes of the window [m], known in the halo: of nodes in pores it
    // changes its sign.
    void close(CellHalo& halo, const Solids& solids, const Array<double>& distance);

private:
    Array<int> found_{
        "treacle::pores", 0}; // [cells of the window] of owned cells and those around: 1: a pore lies around the middle
};

} // namespace treacle::grid
