#pragma once
#include "scene/shapes/mesh.hpp"

#include <array>
#include <functional>

namespace treacle::scene {

// Integrals over a solid of density one, in 2D over its cut, per metre of depth.
struct Moments {
    double volume = 0;             // [m3], [m2] in 2D
    Vec3 centre{0, 0, 0};          // [m]
    std::array<Vec3, 3> inertia{}; // about the centre, in the axes of space [m5]; in 2D only zz [m4]
};

// Exact, by the divergence theorem.
Moments moments_of(const TriangleMesh& mesh);

// Solid for which no exact mesh is known: cells inside count whole, cells on the surface by their signed distance.
struct SampledSolid {
    std::function<double(const Vec3&)> distance; // [m] negative inside
    Bounds bounds;
    int dimensions = 3;
    std::function<double(const Vec3&)> bound; // [m] of the same sign, no larger in magnitude; empty: the distance
    std::function<Vec3(const Vec3&)> normal;  // unit gradient of the distance; empty: by differences
    double volume = 0;                        // exact: the sums are scaled to it; 0: not known
};
// Exact for boxes along the axes; otherwise the error falls with the square of the cells, which are 1/128 of the
// longest edge in 3D, 1/1024 in 2D.
Moments moments_of(const SampledSolid& solid);

} // namespace treacle::scene
