#pragma once
#include "app/setup/geometry.hpp"
#include "base/text/error.hpp"
#include "rigid/bodies.hpp"

namespace treacle::app {

// True when the body's place changes in the run.
bool moves(const scene::Body& body);
bool any_moves(const Input& input);
bool any_dynamic(const Input& input);

// The bodies of the scene with their masses, inertia, and what they touch others with; all at rest count too, since
// the others meet them.
rigid::BodiesSetup make_bodies(const Input& input, const Geometry& geometry);

// Factors on the volumes of the particles of each body: of those that move such that liquid rests at their surface.
std::vector<double> solid_scales(const Input& input, const Geometry& geometry);

// Refuses bodies at the start: dynamic ones inside of others or of walls, or thinner than a spacing; moving ones
// without an extent; dynamic ones that cannot move.
void check_bodies(const Input& input, const Geometry& geometry, std::vector<Diagnostic>& problems);

// Warnings, one sentence each: overlaps of bodies that no force moves, extreme densities.
std::vector<std::string> body_notes(const Input& input, const Geometry& geometry);

// "hinge of wheel to the world, at (0, 1, 0) m".
std::string describe(const scene::Joint& joint);

// Mass per volume of a dynamic body [kg/m3].
double density_of(const scene::Body& body, const scene::SolidRegion& region);

} // namespace treacle::app
