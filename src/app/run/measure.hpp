#pragma once
#include "app/run/simulation.hpp"

namespace treacle::app {

// Value of a measurement of the scene, over all ranks; collective.
//   front   largest coordinate of the liquid along the axis, half a spacing beyond its last particle [m]
//   height  height of the liquid above the domain's floor in the column one spacing to either side of the
//           position; 0 where there is no liquid [m]
//   flow    volume flow through the plane through the position [m3/s], [m2/s] in 2D
// Of all liquids, or of the one that the measurement names.
double measure(const scene::Measurement& measurement, const scene::Scene& scene, const Simulation& solver);

// "front [m]": the measurement's name with its unit.
std::string measurement_column(const scene::Measurement& measurement, const scene::Domain& domain);

} // namespace treacle::app
