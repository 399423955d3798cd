#pragma once
#include "scene/bounds.hpp"
#include "scene/mesh.hpp"
#include "scene/moments.hpp"
#include "scene/shape.hpp"

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
    // obliquely by the plane.
    double distance(const Vec3& x) const;
    Vec3 normal(const Vec3& x) const; // unit, gradient of distance: outward at the surface
    Bounds bounds() const;            // of the region; infinite for planes and inverted shapes
    Bounds surface_bounds() const;    // of its surface; infinite for planes
    double volume() const;            // [m3], in the plane [m2]; infinite for planes and inverted shapes
    double area() const;              // [m2] of the surface, in the plane its length [m]; infinite for planes
    bool closed() const;              // a surface of finite extent: false for planes
    bool inverted() const { return inverted_; }
    int dimensions() const { return dimensions_; }
    const std::optional<MeshReport>& mesh() const { return mesh_; }
    const Surface& surface() const { return *surface_; } // of the shape before inversion
    // Of the shape before inversion, which must be of finite extent: exact for meshes in space.
    Moments moments() const;

private:
    std::shared_ptr<const Surface> surface_;
    std::optional<MeshReport> mesh_;
    std::optional<Moments> mesh_moments_; // in space
    int dimensions_ = 3;
    bool inverted_ = false;
};

} // namespace treacle::scene
