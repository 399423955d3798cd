#pragma once
#include "scene/shapes/bounds.hpp"
#include "scene/shapes/shape.hpp"

namespace treacle::scene {

// Part of a shape in a box, the domain.
inline Shape clipped(const Shape& shape, const Bounds& domain) {
    Shape box;
    box.kind = ShapeKind::box;
    box.min = domain.min;
    box.max = domain.max;
    box.where = shape.where;
    Shape out;
    out.kind = ShapeKind::intersect;
    out.where = shape.where;
    out.clip = true;
    out.parts = {shape, box};
    out.parts.front().clip = false;
    return out;
}

} // namespace treacle::scene
