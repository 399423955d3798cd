#include "scene/shape_options.hpp"

#include "base/options.hpp"

#include <algorithm>

namespace treacle::scene {

namespace {

using Alternative = Declaration::Alternative;
using Alternatives = std::vector<std::pair<ShapeKind, Alternative>>;

const Range positive_length = range_above(0).because("it is a length of a body", "write for instance 5 mm");

void declare_rotation(Declaration& d, Shape& shape, const std::string& centre) {
    d.direction("rotation_axis", shape.rotation_axis, "Axis of the rotation, through " + centre + ".");
    d.number("rotation_angle", shape.rotation_angle, unit::angle, range_any(), "Angle of the rotation.");
    d.vec3("translation", shape.translation, unit::length, "Shift, after the rotation.");
}

void declare_inverted(Declaration& d, Shape& shape) {
    d.boolean("inverted", shape.inverted, "The outside of the shape instead of its inside.");
}

void declare_centre(Declaration& d, Shape& shape, const std::string& doc) {
    d.vec3("centre", shape.centre, unit::length, doc);
    d.required("centre");
}

void declare_radius(Declaration& d, Shape& shape, const std::string& doc) {
    d.number("radius", shape.radius, unit::length, positive_length, doc);
    d.required("radius");
}

void declare_height(Declaration& d, Shape& shape, const std::string& doc) {
    d.number("height", shape.height, unit::length, positive_length, doc);
    d.required("height");
}

void declare_box(Declaration& d, Shape& shape) {
    d.vec3("min", shape.min, unit::length, "Lower corner.");
    d.vec3("max", shape.max, unit::length, "Upper corner.");
    d.required("min");
    d.required("max");
    declare_rotation(d, shape, "the box's centre");
    declare_inverted(d, shape);
    const std::size_t axes = d.plane_vectors() ? 2 : 3;
    for (std::size_t i = 0; i < axes; ++i) {
        d.check(shape.min[i] < shape.max[i], "max",
                {std::string("must be greater than min in ") + "xyz"[i], "the box has no volume",
                 "swap the corners or make it thicker"});
    }
    if (!d.parsing()) return;
    for (std::size_t i = 0; i < 3; ++i) shape.centre[i] = 0.5 * (shape.min[i] + shape.max[i]);
}

void declare_sphere(Declaration& d, Shape& shape) {
    declare_centre(d, shape, "Centre.");
    declare_radius(d, shape, "Radius.");
    declare_inverted(d, shape);
}

// Cylinder, capsule and cone.
void declare_round(Declaration& d, Shape& shape, const std::string& radius, const std::string& height) {
    declare_centre(d, shape, "Middle of the axis.");
    d.direction("axis", shape.axis, "Direction of the axis, of any length.");
    declare_radius(d, shape, radius);
    declare_height(d, shape, height);
    declare_rotation(d, shape, "the centre");
    declare_inverted(d, shape);
}

void declare_torus(Declaration& d, Shape& shape) {
    declare_centre(d, shape, "Centre.");
    d.direction("axis", shape.axis, "Axis of the ring, of any length.");
    declare_radius(d, shape, "Radius of the ring, from the centre to the middle of the tube.");
    d.number("tube_radius", shape.tube_radius, unit::length, positive_length, "Radius of the tube.");
    d.required("tube_radius");
    declare_rotation(d, shape, "the centre");
    declare_inverted(d, shape);
    d.check(shape.tube_radius < shape.radius, "tube_radius",
            {"must be < radius", "otherwise the ring has no hole", "use a sphere or a thinner tube"});
}

void declare_plane(Declaration& d, Shape& shape) {
    d.vec3("point", shape.centre, unit::length, "A point of the plane.");
    d.direction("normal", shape.axis, "Outward normal: the shape is the half space behind it.");
    d.required("point");
    d.required("normal");
    declare_inverted(d, shape);
}

Alternatives primitives(Shape& shape) {
    const auto of = [&shape](void (*declare)(Declaration&, Shape&)) {
        return [&shape, declare](Declaration& d) { declare(d, shape); };
    };
    const auto cylinder = [&shape](Declaration& d) {
        declare_round(d, shape, "Radius.", "Length along the axis.");
    };
    const auto capsule = [&shape](Declaration& d) {
        declare_round(d, shape, "Radius.", "Distance of the centres of the two round ends.");
    };
    const auto cone = [&shape](Declaration& d) {
        declare_round(d, shape, "Radius of the base.", "Height; the apex is in the direction of the axis.");
    };
    return {{ShapeKind::box, Alternative{"box", of(declare_box), "A box, given by two corners."}},
            {ShapeKind::sphere, Alternative{"sphere", of(declare_sphere), "A sphere; in the plane a disc."}},
            {ShapeKind::cylinder, Alternative{"cylinder", cylinder, "A cylinder."}},
            {ShapeKind::capsule, Alternative{"capsule", capsule, "A cylinder with round ends."}},
            {ShapeKind::cone, Alternative{"cone", cone, "A cone."}},
            {ShapeKind::torus, Alternative{"torus", of(declare_torus), "A ring."}},
            {ShapeKind::plane, Alternative{"plane", of(declare_plane), "A half space."}}};
}

// What stands in for a mesh cannot be a mesh: it could be missing as well.
void declare_primitive(Declaration& d, Shape& shape) {
    if (d.parsing()) shape.where = d.place();
    d.one_of(shape.kind, primitives(shape));
}

void declare_mesh(Declaration& d, Shape& shape) {
    d.text(
        "file", shape.file,
        "Closed triangle mesh (OBJ, PLY, STL, ...): looked up beside the scene file, then in the folder of "
        "--data, then in that of TREACLE_DATA.");
    d.required("file");
    d.check(!shape.file.empty(), "file",
            {"must not be empty", "it names a mesh", "write for instance bunny.ply"});
    d.number("scale", shape.scale, unit::none, range_above(0),
             "Factor on the lengths of the file, applied first.");
    d.number(
        "size", shape.size, unit::length, range_at_least(0),
        "When not 0, the longest edge of the bounding box is made this long, and its centre the origin.");
    declare_rotation(d, shape, "the bounding box's centre");
    declare_inverted(d, shape);
    Shape fallback = shape.fallback.empty() ? Shape{} : shape.fallback.front();
    const bool present = d.optional_block(
        "fallback", !shape.fallback.empty(),
        [&](Declaration& inside) { declare_primitive(inside, fallback); },
        "The shape to use, with a message, when the file is not found.");
    shape.fallback.clear();
    if (present) shape.fallback.push_back(fallback);
}

} // namespace

void declare(Declaration& d, Shape& shape) {
    if (d.parsing()) shape.where = d.place();
    auto alternatives = primitives(shape);
    alternatives.push_back(
        {ShapeKind::mesh, Alternative{"mesh", [&shape](Declaration& m) { declare_mesh(m, shape); },
                                      "The inside of a closed triangle mesh."}});
    d.one_of(shape.kind, alternatives);
}

} // namespace treacle::scene
