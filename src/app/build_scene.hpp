#pragma once
#include "app/geometry.hpp"
#include "sph/isph_step.hpp"

#include <memory>

namespace treacle::app {

// Names of what carries loads: the six sides of the domain, then the bodies.
std::vector<std::string> load_names(const Input& input);

// Throws InputError for what the SPH method does not do: several densities, moving bodies, slip lengths.
void check_supported(const Input& input);

// A solver for the scene without particles. Collective.
std::unique_ptr<sph::IsphStep> make_solver(const Comm& comm, const Input& input, const Geometry& geometry);

// Puts the scene's particles into the solver and starts it. Collective; each rank makes those of its own box.
void fill_solver(const Input& input, const Geometry& geometry, sph::IsphStep& solver);

} // namespace treacle::app
