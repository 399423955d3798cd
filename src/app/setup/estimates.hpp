#pragma once
#include "app/setup/geometry.hpp"

#include <string>
#include <vector>

namespace treacle::app {

// Estimates of a run of a scene before it starts.
struct Estimates {
    double length = 0;         // H [m]: height of the liquid along gravity, or without gravity its longest edge
    double speed = 0;          // U [m/s]: the larger of sqrt(g H) and the initial speed
    double initial_speed = 0;  // [m/s] of the fastest liquid
    double courant_step = 0;   // [s] cfl d / U; infinite at rest
    double gravity_step = 0;   // [s] cfl sqrt(d / g)
    double viscous_step = 0;   // [s] of the explicit viscosity; infinite without
    double capillary_step = 0; // [s] of the surface tension; infinite without
    double poured = 0;         // particles that flow in by the end
    double step = 0;           // [s] that the run would take by these
    double steps = 0;          // in the whole run
    double bytes = 0;          // on all ranks
};
Estimates estimate_run(const Input& input, const Geometry& geometry, std::uint64_t liquid, std::uint64_t solid);

// Lines such as "Reynolds number  rho U H / mu = 1.2e+05", those that have a meaning for the scene.
struct DimensionlessNumber {
    std::string name, formula;
    double value = 0; // [-]
};
std::vector<DimensionlessNumber> dimensionless_numbers(const Input& input, const Estimates& estimates);

} // namespace treacle::app
