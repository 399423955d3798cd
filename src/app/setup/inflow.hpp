#pragma once
#include "app/setup/geometry.hpp"
#include "base/text/error.hpp"
#include "flow/inflow.hpp"

namespace treacle::app {

// The inlets and outlets of the scene as the solver takes them. Needs shapes and places, no particles.
flow::InflowSetup make_inflow(const Input& input);

// InputError for inlets with faults: outside of the domain, in a solid, where liquid is at the start, in each other or
// in an outlet; smaller than a particle.
void check_inflow(const Input& input, const Geometry& geometry, std::vector<Diagnostic>& problems);

// Warnings, one sentence each: openings of a few particles.
std::vector<std::string> inflow_notes(const Input& input);

// Particles that an inlet makes in the whole run, and volume that it lets in in a second [m3/s].
std::uint64_t inflow_particles(const Input& input, const flow::InletSetup& inlet);
double flow_of(const Input& input, const flow::InletSetup& inlet);
std::uint64_t inflow_particles(const Input& input); // of all inlets

} // namespace treacle::app
