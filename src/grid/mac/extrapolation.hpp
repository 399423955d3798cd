#pragma once
#include "grid/mac/mac_grid.hpp"
#include "mpi/cell_halo.hpp"

namespace treacle::grid {

// Marks of the faces of a window that have a velocity: 0 none, 1 of the liquid, 2 and more by extrapolation, layer by
// layer.
struct FaceValidity {
    Array<int> axis[3]; // [window], by the axis that the faces are across
};

// Marks the faces where the field is above `least`, and no others.
void mark_faces(const MacGrid& grid, const CellBox& window, const FaceField& field, double least, FaceValidity& known);

// Collective. Faces without velocity take the mean of their neighbours along the axes that have one, `layers` times,
// each layer from those before. On return the halo is up to date. Faces beyond the active block keep what they have.
void extrapolate(const MacGrid& grid, CellHalo& halo, FaceField& velocity, FaceValidity& known, int layers);

} // namespace treacle::grid
