#pragma once
#include "scene/shapes/bounds.hpp"
#include "scene/shapes/mesh.hpp"
#include "scene/shapes/moments.hpp"
#include "scene/shapes/shape.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace treacle::scene {

class Surface;

// A solid region made from a shape: signed distance, normal, extent. Copies share their data. Thread-safe.
class SolidRegion {
public:
    // `dimensions` 2: the cut of the shape at z = 0. Of a mesh, the file that it names (data_files.hpp finds it). InputError
    // for impossible parameters, a mesh that is missing or not closed, and a shape that does not meet the plane of the cut.
    explicit SolidRegion(const Shape& shape, int dimensions = 3);

    // [m] negative inside. Exact for primitives and triangles; within 1e-5 of the size for primitives cut
    // obliquely by the plane. Of unions, intersections and differences exact where the nearest point of one part
    // is on the surface of the whole, elsewhere within 1e-3 of the size but at corners of three parts, where they may be too
    // large by 1/48 of the size, in 2D 1/512 (src/scene/solid.hpp); of those without end a lower bound.
    // Knowledge of it makes it quicker for meshes (scene/sampling/nearby_distance.hpp).
    double distance(const Vec3& x, DistanceBound known = {}) const;
    Vec3 normal(const Vec3& x) const; // unit, gradient of distance: outward at the surface
    Bounds bounds() const;            // of the region; infinite for planes and inverted shapes
    Bounds surface_bounds() const;    // of its surface; infinite for planes
    double volume() const;            // [m3], in 2D [m2]; infinite for planes and inverted shapes
    double area() const;              // [m2] of the surface, in 2D its length [m]; infinite for planes
    bool closed() const;              // a surface of finite extent: false for planes
    bool inverted() const { return inverted_; }
    int dimensions() const { return dimensions_; }
    const std::vector<MeshReport>& meshes() const { return meshes_; } // that it is made of
    const Surface& surface() const { return *surface_; }              // of the shape before inversion
    // Moments of the shape before inversion, which must be of finite extent: exact for meshes in 3D; of joined
    // shapes the volume is within 5e-4, the inertia within 1e-3 of those of boxes, balls and cylinders without others.
    Moments moments() const;

private:
    std::shared_ptr<const Surface> surface_;
    std::vector<MeshReport> meshes_;
    std::optional<Moments> moments_; // of meshes in 3D and of joined shapes
    int dimensions_ = 3;
    bool inverted_ = false;
};

} // namespace treacle::scene
