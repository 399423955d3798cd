#pragma once
#include "flow/inflow.hpp"
#include "grid/mac/mac_grid.hpp"
#include "grid/mac/particles.hpp"
#include "mpi/decomposition.hpp"
#include "rigid/bodies.hpp"

namespace treacle::grid {

// Inlets (I). Behind an opening stands a plug whose surface moves at the inlet's speed while it stays in its place: a body
// like others to all solves. The pressure gets the plug's flux through the faces at the opening, the viscous stress holds
// the liquid there to the plug's velocity. What it makes room for is filled by layers of the lattice of half a cell's width,
// as they pass the opening; the opening's area is that of the layers, so that volumes of grid and particles agree.

inline constexpr int inlet_body_layers = 4; // behind the opening: two cells, past which no stress reaches

flow::Layers layers_of(const MacGrid& grid); // dx/2 apart, none kept behind the opening

// The plugs of all inlets, as bodies that convey.
std::vector<rigid::BodySetup> make_inlet_bodies(const flow::InflowSetup& setup, const MacGrid& grid);

// Source of the layers of all inlets, with layers_of().
flow::InletEmitter make_inlet_emitter(const flow::InflowSetup& setup, const MacGrid& grid);

// Begin and end of a step; layers due at the end belong to it.
struct TimeSpan {
    double begin, end; // [s]
};
// Puts in the layers that pass their openings within the time, where they are at its end; each rank those of its own cells.
// Ghosts are dropped.
void emit_layers(const flow::InletEmitter& source, const TimeSpan& time, const Decomposition& decomposition,
    GridParticles& particles);

} // namespace treacle::grid
