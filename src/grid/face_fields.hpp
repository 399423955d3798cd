#pragma once
#include "grid/extrapolation.hpp"
#include "grid/pressure_faces.hpp"
#include "grid/solids.hpp"

#include <array>

namespace treacle::grid {

// Makes room for a number per face of a window.
void reserve_faces(FaceField& field, const MacGrid& grid, const CellBox& window);
// Collective: halo faces take the values of their owners.
void gather_faces(const MacGrid& grid, CellHalo& halo, const FaceField& field);

// (A1) u += g dt on all faces of the window.
void accelerate(const MacGrid& grid, const CellBox& window, const std::array<double, 3>& g, double dt,
                const FaceField& velocity);

// Marks the faces whose velocity a projection found: open ones beside liquid.
void mark_projected(const PressureFaces& faces, FaceMarks& known);

// (A2) Collective: velocities of closed faces, found by extrapolation, lose what leads into or out of their solid, so that
// particles near solids move along them. `scratch` takes a copy.
void turn_along_solids(const MacGrid& grid, CellHalo& halo, const Solids& solids, const PressureFaces& faces,
                       const FaceField& velocity, FaceField& scratch);

} // namespace treacle::grid
