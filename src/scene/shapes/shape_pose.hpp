#pragma once
// Private to src/scene.
#include "scene/shapes/shape.hpp"
#include "scene/shapes/vector_math.hpp"

#include <array>

namespace treacle::scene {

// A rotation about the origin, then a shift [m]: where a shape stands that is a part of others.
struct ShapePose {
    std::array<Vec3, 3> columns{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}; // the turned axes
    // Added after the rotation [m].
    Vec3 shift{0, 0, 0};
    bool turned = false; // false: the columns are the axes themselves

    // Direction, or position from the origin [m]; and position in the place of the shape [m].
    Vec3 turn(const Vec3& v) const { return turned ? v[0] * columns[0] + v[1] * columns[1] + v[2] * columns[2] : v; }
    Vec3 at(const Vec3& x) const { return turn(x) + shift; }

    // This one after another one.
    ShapePose after(const ShapePose& first) const {
        ShapePose out;
        for (std::size_t k = 0; k < 3; ++k) out.columns[k] = turn(first.columns[k]);
        out.shift = at(first.shift);
        out.turned = turned || first.turned;
        return out;
    }
};

// The rotation of a shape about its `centre`, then its translation.
inline ShapePose pose_of(const Shape& shape) {
    ShapePose out;
    out.turned = shape.rotation_angle != 0;
    if (out.turned) {
        for (Vec3& column : out.columns) column = rotated(column, unit(shape.rotation_axis), shape.rotation_angle);
    }
    out.shift = shape.centre - out.turn(shape.centre) + shape.translation;
    return out;
}

} // namespace treacle::scene
