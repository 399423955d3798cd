#pragma once
#include "app/setup/geometry.hpp"
#include "video/pose/solid_view.hpp"

namespace treacle::app {

// A liquid at the start of a run, within the domain and outside of the bodies if it leaves these out.
video::SeenSolid seen_liquid(const Input& input, const Geometry& geometry, std::size_t liquid);
// A body of finite extent at its start.
video::SeenSolid seen_body(const Input& input, const Geometry& geometry, std::size_t body);

// "" or "liquid": all liquids as one; else the liquid or body of that name. InputError that lists the names; for a body
// without end; for a scene in two dimensions.
video::SeenSolid find_seen_solid(const Input& input, const Geometry& geometry, const std::string& name);

} // namespace treacle::app
