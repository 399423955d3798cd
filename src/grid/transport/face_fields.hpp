#pragma once
#include "grid/geometry/solids.hpp"
#include "grid/mac/extrapolation.hpp"
#include "grid/mac/pressure_faces.hpp"

#include <array>

namespace treacle::grid {

// Makes room for a number per face of a window.
void reserve_faces(FaceField& field, const MacGrid& grid, const CellBox& window);
// Collective: halo faces take the values of their owners.
void gather_faces(const MacGrid& grid, CellHalo& halo, const FaceField& field);

// out = a - b on all faces of the window.
void subtract_faces(const MacGrid& grid, const CellBox& window, const FaceField& a, const FaceField& b, FaceField& out);

// (A1) u += g dt on all faces of the window.
void accelerate(
    const MacGrid& grid, const CellBox& window, const std::array<double, 3>& g, double dt, const FaceField& velocity);

// Spread by viscosity in a step of dt [s].
struct DiffusionNumber {
    Array<double> cell;         // [Pa s]; without one: nothing
    double density = 1, dt = 0; // [kg/m3], [s]
    // Distance that a velocity spreads into a cell within the step, squared, over (dx/2)^2.
    KOKKOS_INLINE_FUNCTION double diffusion_number(std::size_t i, double dx) const {
        return cell(i) / density * dt / (0.25 * dx * dx);
    }
};

// Shares of the faces' cubes that are liquid, and the least that counts.
struct WetFractions {
    const FaceField& fraction; // [window] [1]
    double least;              // [1]
};

// Marks the faces whose velocity the solves found: open ones beside liquid; and those with wet shares from the least on where the
// viscosity reaches over half a cell. Thinner liquid beyond the pressure's faces does there what gravity makes of it: a dam
// break of water in steps of three cells heaped up to thousands of particles in a cell, which followed such faces into walls.
void mark_valid_faces(const PressureFaces& faces, const WetFractions& wet, const DiffusionNumber& viscosity, double dx,
    FaceValidity& known);

// Faces beyond those of the solves, that velocities go on to.
struct FaceScene {
    const MacGrid& grid;
    CellHalo& halo;
    const PressureFaces& faces;
};

// Condition by which solids hold the liquid along them.
struct WallCondition {
    bool any = false;     // without viscosity: none
    Array<double> length; // [6 sides, then bodies] slip lengths [m], 0: no slip, infinity: does not hold
    DiffusionNumber viscosity;
    Array<int> leaves; // [window] 1: cells whose liquid separates from solids (separation.hpp); none: no extent
};

// (A2) Collective: velocities of closed faces, found by extrapolation, lose what leads into or out of their solid (of cells that separate: into it), so that
// particles near solids move along them; and are those of a velocity that falls linearly to the solid's a slip length behind
// its surface, as far as viscosity spreads within the step: nu dt over that and (dx/2)^2. `scratch` takes a copy.
void enforce_wall_velocity(const FaceScene& scene, const Solids& solids, const WallCondition& condition,
    const FaceField& velocity, FaceField& scratch);

// (A6) Collective: what the step has changed since `start` at the faces that are known goes on to open faces around them that
// particles gave a velocity, which have a mass: start + change, and known from then on. A mean of the neighbours'
// velocities in its place would slow whatever turns. In solids no one would ever set such a face right.
struct Extrapolated {
    const FaceField& start;
    const FaceField& mass;
    FaceField& change;          // scratch
    FaceValidity& extrapolated; // scratch
};
void extrapolate_increment(
    const FaceScene& scene, const Extrapolated& with, FaceValidity& known, const FaceField& velocity);
// Copies the numbers of the window.
void copy_faces(const MacGrid& grid, const CellBox& window, const FaceField& from, FaceField& to);

} // namespace treacle::grid
