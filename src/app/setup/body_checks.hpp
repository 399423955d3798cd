#pragma once
#include "app/setup/geometry.hpp"
#include "base/text/error.hpp"

namespace treacle::app {

// InputError for bodies at the start: dynamic ones inside of others or of walls, or thinner than a spacing; moving ones
// without an extent; dynamic ones that cannot move.
void check_bodies(const Input& input, const Geometry& geometry, std::vector<Diagnostic>& problems);

// Warnings, one sentence each: overlaps of bodies that no force moves, extreme densities.
std::vector<std::string> body_warnings(const Input& input, const Geometry& geometry);

} // namespace treacle::app
