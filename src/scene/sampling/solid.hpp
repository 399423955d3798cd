#pragma once
// Private to src/scene: what a shape is made of.
#include "scene/sampling/surface.hpp"
#include "scene/shapes/moments.hpp"

#include <optional>
#include <string>
#include <vector>

namespace treacle::scene {

// A surface's inside, or solids joined. In the plane, a shape that does not meet z = 0 is nowhere: without a surface and parts.
struct Solid {
    enum class Join { unite, intersect };

    SurfacePointer surface;      // null: of parts, or nowhere
    bool crosses_itself = false; // the surface has pieces inside of what it bounds
    Join join = Join::unite;     // of `parts`
    std::vector<Solid> parts;    // empty: `surface` alone
    bool inverted = false;       // the outside of it

    bool joined() const { return !parts.empty() || crosses_itself; } // true: its surface comes from join()
};

// Notes on a solid: reports on its meshes, and exact moments.
struct SolidNotes {
    std::vector<MeshReport> meshes;
    std::optional<Moments> moments; // of the one mesh, when exact
};

// The solid of a shape, and of its parts. InputError as SolidRegion's.
Solid make_solid(const Shape& shape, int dimensions, SolidNotes& notes);

// For messages.
const char* name_of(ShapeKind kind);

// The surface of joined solids: distances by the parts', exact wherever the nearest point of a part is one of the whole, which
// is near the surface everywhere but where parts meet. There, the nearest of points that lie on the surface, those of the
// edges along which parts meet among them, is moved along it to where it is nearest; the result is within
// 1e-3 of the size, at corners of three parts within the points' distance, 1/48 of the longest edge, in 2D 1/512. Null for no surface: an empty solid, or all of
// space. A solid without end has the distances of the parts alone, whose magnitudes are lower bounds.
SurfacePointer join(const Solid& solid, int dimensions);
// Bounds of the region that a solid is; infinite without end.
Bounds bounds_of(const Solid& solid);

} // namespace treacle::scene
