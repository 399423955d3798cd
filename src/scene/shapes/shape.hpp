#pragma once
#include "base/text/vec3.hpp"

#include <string>
#include <vector>

namespace treacle::scene {

// Kinds of shapes; unite, intersect and subtract have the keys union, intersection and difference.
enum class ShapeKind { box, sphere, cylinder, capsule, cone, torus, plane, mesh, unite, intersect, subtract };

// A solid region of space as the scene file gives it. Lengths [m], angles [rad]. In 2D scenes (two
// dimensions) the region is its cut at z = 0. Signed distances are negative inside.
struct Shape {
    ShapeKind kind = ShapeKind::box;
    Vec3 min{0, 0, 0};         // box: lower corner
    Vec3 max{0, 0, 0};         // box: upper corner
    Vec3 centre{0, 0, 0};      // sphere, cylinder, capsule, cone, torus: middle; plane: a point of it
    Vec3 axis{0, 1, 0};        // cylinder, capsule, cone (towards the apex), torus; plane: outward normal
    double radius = 0;         // sphere, cylinder, capsule, cone (at its base), torus (of the ring)
    double tube_radius = 0;    // torus: of the tube
    double height = 0;         // cylinder, capsule (between its two centres), cone; centre is halfway
    std::string file;          // mesh: as written in the scene
    double scale = 1;          // mesh: applied first
    double size = 0;           // mesh: when > 0, scaled so that its bounding box has this longest edge
    Vec3 translation{0, 0, 0}; // applied last; mesh: also when size > 0, after centring at the origin
    // About `centre` (box, mesh: the middle of its bounding box; of parts: the origin unless given), of any length.
    Vec3 rotation_axis{0, 0, 1};
    double rotation_angle = 0;   // [rad] about rotation_axis
    bool inverted = false;       // the outside of the shape
    std::vector<Shape> parts;    // unite, intersect; subtract: the first one without the others
    bool clip = false;           // cut at the domain, scene/clip.hpp
    bool nested = false;         // one of the parts of another shape
    std::vector<Shape> fallback; // mesh: at most one shape, used when the file is not found
    std::string where;           // "scene.yaml:14", for messages
};

} // namespace treacle::scene
