#pragma once
#include "flow/end_motion.hpp"
#include "grid/mac/mac_grid.hpp"
#include "grid/mac/particles.hpp"

namespace treacle::grid {

using flow::EndMotion;
using flow::StepTimes;

// (E) Sets end_velocity() and acceleration() of the owned particles, whose velocity() is that of the middle. `change` [window]:
// what the step made of the velocities of the faces [m/s]. Before the particles move. Local.
void end_velocities(const MacGrid& grid, const CellBox& window, const FaceField& change, const StepTimes& times,
    const GridParticles& particles);
// As at rest, of the owned particles from `begin` on: end_velocity() is velocity().
void begin_velocities(const GridParticles& particles, int begin);

} // namespace treacle::grid
