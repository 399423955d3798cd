#pragma once
#include "app/setup/geometry.hpp"
#include "base/text/error.hpp"
#include "rigid/bodies.hpp"

namespace treacle::app {

// True when the body's place changes in the run.
bool moves(const scene::Body& body);
// True for a body that liquid and contacts move.
bool dynamic(const scene::Body& body);
bool any_moves(const Input& input);
bool any_dynamic(const Input& input);

// Points on a body's surface, those of planes in the domain only.
scene::SurfaceSampling on_surface(const Geometry& geometry, const scene::SolidRegion& region);

// Contacts that a body may have: without any, one that rests needs no points to touch others with.
enum class Contacts { possible, none };
// A body of the scene by its number, as in make_bodies().
rigid::BodySetup make_body(const scene::Body& body, std::size_t number, const Geometry& geometry, Contacts contacts);

// The bodies of the scene with their masses, inertia, and what they touch others with; all at rest count too, since
// the others meet them.
rigid::BodiesSetup make_bodies(const Input& input, const Geometry& geometry);

// Factors on the volumes of the particles of each body: of those that move such that liquid rests at their surface.
std::vector<double> boundary_volume_factors(const Input& input, const Geometry& geometry);

// "hinge of wheel to the world, at (0, 1, 0) m".
std::string describe(const scene::Joint& joint);

// Mass per volume of a dynamic body [kg/m3].
double density_of(const scene::Body& body, const scene::SolidRegion& region);

} // namespace treacle::app
