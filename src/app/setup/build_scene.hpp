#pragma once
#include "app/setup/geometry.hpp"
#include "sph/isph_step.hpp"

#include <memory>

namespace treacle::app {

// Names of what carries loads: the six sides of the domain, then the bodies.
std::vector<std::string> load_names(const Input& input);

// Throws InputError for what the SPH method does not do, as several liquids with another solver than isph.
void check_supported(const Input& input);

// Parts of the scene that the method leaves out without harm, one sentence each: the surface tension of a material.
std::vector<std::string> method_notes(const Input& input);

// Speed of the artificial viscosity unless the scene gives one: sqrt(g H), with the height H of the liquid at the
// start [m/s].
double reference_speed(const Input& input, const Geometry& geometry);

// A solver for the scene without particles. Collective. The speed is that of the artificial viscosity. The geometry
// is needed where bodies move.
std::unique_ptr<sph::IsphStep> make_solver(
    const Comm& comm, const Input& input, double reference_speed, const Geometry& geometry);

// Puts the scene's particles into the solver and starts it. Collective; each rank makes those of its own box.
// Returns notes for the user about the scene: fallbacks, thin bodies, what is not modelled.
std::vector<std::string> fill_solver(const Input& input, const Geometry& geometry, sph::IsphStep& solver);

} // namespace treacle::app
