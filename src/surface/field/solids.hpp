#pragma once
#include "scene/sampling/signed_distance.hpp"

#include <array>
#include <vector>

namespace treacle::surface {

// A solid region in its present place: x = rotation (x0 - centre) + centre + translation of the points x0 at the start.
struct Solid {
    scene::SolidRegion region;
    std::array<Vec3, 3> rotation{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}; // rows
    Vec3 centre{0, 0, 0};                                                      // [m]
    Vec3 translation{0, 0, 0};                                                 // [m]

    Vec3 to_start(const Vec3& x) const;    // [m]
    Vec3 to_present(const Vec3& x0) const; // [m]
    double distance(const Vec3& x) const;  // [m] negative in the solid
    Vec3 normal(const Vec3& x) const;      // unit, out of the solid
};

// The solids in which the liquid's function goes on, and at whose surface it is cut.
struct Solids {
    std::vector<Solid> bodies;

    double distance(const Vec3& x) const; // [m] to the nearest; 1e300 without any
};

} // namespace treacle::surface
