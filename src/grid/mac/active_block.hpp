#pragma once
#include "grid/mac/mac_grid.hpp"
#include "mpi/comm.hpp"

namespace treacle::grid {

// Collective: the block of cells that arrays reach over, the same on all ranks: those with particles and `band` more on
// each side, rounded outwards to a few cells so that it seldom changes, within the grid. It follows from the particles
// alone, whatever came before. `occupied`: this rank's cells with particles.
CellBox active_block(const Comm& comm, const MacGrid& grid, const CellBox& occupied, int band);

} // namespace treacle::grid
