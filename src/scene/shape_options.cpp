#include "scene/shape_options.hpp"

#include "base/options/options.hpp"

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
    d.boolean("clip", shape.clip,
        "Cuts the shape at the domain's sides, as for a quarter of a ball in a corner between free-slip walls; "
        "`treacle check` says how much is cut off.");
    d.check(!shape.clip || !shape.nested, "clip",
        {"must stand at the outermost shape", "the domain cuts the whole of it, not its parts", "move it there"});
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
    const auto cylinder = [&shape](Declaration& d) { declare_round(d, shape, "Radius.", "Length along the axis."); };
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

// A stand-in for a mesh cannot be a mesh: it could be missing as well.
void declare_primitive(Declaration& d, Shape& shape) {
    if (d.parsing()) shape.where = d.location();
    d.one_of(shape.kind, primitives(shape));
}

void declare_mesh(Declaration& d, Shape& shape) {
    d.text("file", shape.file,
        "Closed triangle mesh (OBJ, PLY, STL, ...): looked up beside the scene file, then in the folder of "
        "--data, then in that of TREACLE_DATA.");
    d.required("file");
    d.check(!shape.file.empty(), "file", {"must not be empty", "it names a mesh", "write for instance bunny.ply"});
    d.number("scale", shape.scale, unit::none, range_above(0), "Factor on the lengths of the file, applied first.");
    d.number("size", shape.size, unit::length, range_at_least(0),
        "When not 0, the longest edge of the bounding box is made this long, and its centre the origin.");
    declare_rotation(d, shape, "the bounding box's centre");
    declare_inverted(d, shape);
    Shape fallback = shape.fallback.empty() ? Shape{} : shape.fallback.front();
    const bool present = d.optional_block(
        "fallback", !shape.fallback.empty(), [&](Declaration& inside) { declare_primitive(inside, fallback); },
        "The shape to use, with a message, when the file is not found.");
    shape.fallback.clear();
    if (present) shape.fallback.push_back(fallback);
}

// A shape inside a shape. Its manual is the one further up.
void declare_part(Declaration& d, Shape& part) {
    if (d.told_elsewhere()) return;
    part.nested = true;
    declare(d, part);
}

void declare_parts(Declaration& d, std::vector<Shape>& parts, const std::string& key, const std::string& doc) {
    Declaration::Items items;
    items.size = [&parts] { return parts.size(); };
    items.clear = [&parts] { parts.clear(); };
    items.append = [&parts] { parts.emplace_back(); };
    items.declare = [&parts](std::size_t i, Declaration& inside) { declare_part(inside, parts[i]); };
    items.declare_default = [](Declaration& inside) {
        Shape part;
        declare_part(inside, part);
    };
    d.list_of(key, items, doc);
    d.required(key);
    d.check(!parts.empty(), key,
        {"must not be empty", "it is a list of shapes", "add a shape, or write what is left as it is"});
}

void declare_pose(Declaration& d, Shape& shape) {
    d.vec3("centre", shape.centre, unit::length, "Point that the rotation leaves where it is.");
    declare_rotation(d, shape, "the centre");
    declare_inverted(d, shape);
}

// Union and intersection.
void declare_joined(Declaration& d, Shape& shape) {
    declare_parts(
        d, shape.parts, "shapes", "The shapes: of any kind, these among them, each with its own place and rotation.");
    declare_pose(d, shape);
}

void declare_difference(Declaration& d, Shape& shape) {
    Shape from = shape.parts.empty() ? Shape{} : shape.parts.front();
    std::vector<Shape> others(shape.parts.empty() ? shape.parts.begin() : shape.parts.begin() + 1, shape.parts.end());
    d.block_of(
        "from", [&](Declaration& inside) { declare_part(inside, from); }, "The shape that is cut, of any kind.");
    d.required("from");
    declare_parts(d, others, "subtract", "The shapes that are taken out of it, of any kind.");
    declare_pose(d, shape);
    if (!d.parsing()) return;
    shape.parts = {from};
    shape.parts.insert(shape.parts.end(), others.begin(), others.end());
}

} // namespace

void declare(Declaration& d, Shape& shape) {
    if (d.parsing()) shape.where = d.location();
    auto alternatives = primitives(shape);
    const auto add = [&](ShapeKind kind, const char* key, void (*members)(Declaration&, Shape&), const char* doc) {
        alternatives.push_back({kind, Alternative{key, [&shape, members](Declaration& m) { members(m, shape); }, doc}});
    };
    add(ShapeKind::mesh, "mesh", declare_mesh, "The inside of a closed triangle mesh.");
    add(ShapeKind::unite, "union", declare_joined, "What is in one of several shapes.");
    add(ShapeKind::intersect, "intersection", declare_joined, "What is in all of several shapes.");
    add(ShapeKind::subtract, "difference", declare_difference,
        "A shape without other shapes: a vessel with a hole, a pipe, a hollow body.");
    d.one_of(shape.kind, alternatives);
}

} // namespace treacle::scene
