#include "scene/sampling/solid.hpp"

#include "base/text/error.hpp"
#include "scene/shapes/shape_pose.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace treacle::scene {

const char* name_of(ShapeKind kind) {
    switch (kind) {
    case ShapeKind::box: return "box";
    case ShapeKind::sphere: return "sphere";
    case ShapeKind::cylinder: return "cylinder";
    case ShapeKind::capsule: return "capsule";
    case ShapeKind::cone: return "cone";
    case ShapeKind::torus: return "torus";
    case ShapeKind::plane: return "plane";
    case ShapeKind::mesh: return "mesh";
    case ShapeKind::unite: return "union";
    case ShapeKind::intersect: return "intersection";
    case ShapeKind::subtract: return "difference";
    }
    return "shape";
}

namespace {

[[noreturn]] void reject_value(
    const Shape& shape, const std::string& problem, const std::string& reason, const std::string& cure) {
    throw InputError({shape.where, problem, reason, cure});
}

std::string text(double value) {
    std::ostringstream out;
    out << value;
    return out.str();
}

void require_positive(const Shape& shape, const char* key, double value) {
    if (value > 0 && std::isfinite(value)) return;
    reject_value(shape, std::string(name_of(shape.kind)) + "." + key + " = " + text(value) + ": must be > 0",
        "a region has an extent", "give a length in metres or with its unit");
}

void require_finite(const Shape& shape, const char* key, const Vec3& value) {
    if (is_finite(value)) return;
    reject_value(shape, std::string(name_of(shape.kind)) + "." + key + " is not finite", "", "give three numbers");
}

void require_direction(const Shape& shape, const char* key, const Vec3& value) {
    if (is_finite(value) && length(value) > 0) return;
    reject_value(shape, std::string(name_of(shape.kind)) + "." + key + " has no direction",
        "its three components are zero or not finite", "give a vector such as [0, 1, 0]");
}

Vec3 turned(const Shape& shape, const Vec3& v) {
    return shape.rotation_angle == 0 ? v : rotated(v, unit(shape.rotation_axis), shape.rotation_angle);
}

// A shape that does not meet the plane z = 0 of a 2D scene.
struct Nowhere {};

SurfacePointer cut_of(const SurfacePointer& body) {
    const auto pieces = slice(*body);
    if (pieces.empty()) throw Nowhere{};
    return make_cross_section(pieces, [body](const Vec3& x) { return body->nearest(x).distance < 0; });
}

SurfacePointer box_of(const Shape& shape, int dimensions, const ShapePose& outer_pose) {
    require_finite(shape, "min", shape.min);
    require_finite(shape, "max", shape.max);
    for (int a = 0; a < dimensions; ++a)
        if (!(shape.max[a] > shape.min[a]))
            reject_value(shape,
                std::string("box.max = ") + text(shape.max[a]) + " m is not above box.min = " + text(shape.min[a]) +
                    " m along " + "xyz"[a],
                "a box has an extent along each axis", "exchange or correct the two corners");
    BoxPose pose;
    pose.min = shape.min + shape.translation + outer_pose.shift;
    pose.max = shape.max + shape.translation + outer_pose.shift;
    if (dimensions == 2 && !(pose.max[2] > pose.min[2])) pose.min[2] = -1, pose.max[2] = 1; // z plays no role
    pose.half = 0.5 * (pose.max - pose.min);
    pose.centre = outer_pose.at(0.5 * (shape.min + shape.max) + shape.translation);
    pose.turned = outer_pose.turned || shape.rotation_angle != 0;
    for (Vec3& axis : pose.axes) axis = outer_pose.turn(turned(shape, axis));
    constexpr double straight = 1e-12; // of a unit vector, after rotations
    const bool about_z = std::hypot(pose.axes[2][0], pose.axes[2][1]) < straight;
    if (dimensions == 2 && pose.turned && !about_z) return cut_of(make_box(pose, 3));
    return make_box(pose, dimensions);
}

// The cut of a body whose axis is z: discs and rings.
SurfacePointer ring_of(const SurfaceOfRevolution& body) {
    const double z = body.centre[2], up = body.axis[2] < 0 ? -1 : 1, half = 0.5 * body.height;
    double outer = body.radius, inner = 0;
    switch (body.profile) {
    case Profile::sphere: outer = std::sqrt(std::max(0.0, outer * outer - z * z)); break;
    case Profile::cylinder: outer = std::abs(z) < half ? outer : 0; break;
    case Profile::capsule: {
        const double beyond = std::max(0.0, std::abs(z) - half);
        outer = std::sqrt(std::max(0.0, outer * outer - beyond * beyond));
        break;
    }
    case Profile::cone: outer = std::abs(z) < half ? outer * (half + up * z) / body.height : 0; break;
    case Profile::torus: {
        const double w = std::sqrt(std::max(0.0, body.tube * body.tube - z * z));
        inner = w > 0 ? body.radius - w : 0;
        outer = w > 0 ? body.radius + w : 0;
    }
    }
    if (!(outer > inner)) throw Nowhere{};
    return make_ring(body.centre, inner, outer);
}

SurfacePointer round_of(const Shape& shape, int dimensions, const ShapePose& outer_pose) {
    require_finite(shape, "centre", shape.centre);
    require_positive(shape, "radius", shape.radius);
    SurfaceOfRevolution body;
    switch (shape.kind) {
    case ShapeKind::cylinder: body.profile = Profile::cylinder; break;
    case ShapeKind::capsule: body.profile = Profile::capsule; break;
    case ShapeKind::cone: body.profile = Profile::cone; break;
    case ShapeKind::torus: body.profile = Profile::torus; break;
    default: body.profile = Profile::sphere;
    }
    body.centre = outer_pose.at(shape.centre + shape.translation);
    body.radius = shape.radius;
    if (body.profile == Profile::torus) {
        require_positive(shape, "tube_radius", shape.tube_radius);
        if (shape.tube_radius >= shape.radius)
            reject_value(shape,
                "torus.tube_radius = " + text(shape.tube_radius) +
                    " m: must be below torus.radius = " + text(shape.radius) + " m",
                "the tube would fill the hole", "lower the tube's radius");
        body.tube = shape.tube_radius;
    } else if (body.profile != Profile::sphere) {
        require_positive(shape, "height", shape.height);
        body.height = shape.height;
    }
    if (body.profile != Profile::sphere) {
        require_direction(shape, "axis", shape.axis);
        body.axis = unit(outer_pose.turn(turned(shape, unit(shape.axis))));
    }
    if (dimensions == 3) return make_revolved(body);
    constexpr double straight = 1e-12; // of a unit vector, after rotations
    if (body.profile == Profile::sphere || std::hypot(body.axis[0], body.axis[1]) < straight) return ring_of(body);
    if (std::abs(body.axis[2]) < straight && body.centre[2] == 0) {
        body.axis = unit({body.axis[0], body.axis[1], 0});
        return make_outline(body);
    }
    return cut_of(make_revolved(body));
}

SurfacePointer plane_of(const Shape& shape, int dimensions, const ShapePose& outer_pose) {
    require_finite(shape, "centre", shape.centre);
    require_direction(shape, "axis", shape.axis);
    const Vec3 point = outer_pose.at(shape.centre + shape.translation);
    const Vec3 normal = unit(outer_pose.turn(turned(shape, unit(shape.axis))));
    if (dimensions == 3) return make_plane(point, normal, 3);
    const Vec3 flat{normal[0], normal[1], 0};
    const double l = length(flat);
    if (l < 1e-12) reject_value(shape, "plane.axis points along z", "a plane scene has no third direction", "tilt it");
    // The line where the plane meets z = 0.
    const Vec3 base{point[0], point[1], 0};
    return make_plane(base + (point[2] * normal[2] / (l * l)) * flat, (1 / l) * flat, 2);
}

void pose_mesh(CheckedMesh& checked, const Shape& shape, const ShapePose& outer_pose) {
    const Bounds& box = checked.report.bounds;
    const Vec3 extent = box.max - box.min, middle = 0.5 * (box.min + box.max);
    const double longest = std::max({extent[0], extent[1], extent[2]});
    const double factor = shape.size > 0 ? shape.size / longest : shape.scale;
    const Vec3 centre = shape.size > 0 ? Vec3{0, 0, 0} : factor * middle;
    Bounds moved = Bounds::nothing();
    for (Vec3& v : checked.mesh.vertices) {
        v = outer_pose.at(centre + turned(shape, factor * (v - middle)) + shape.translation);
        for (int a = 0; a < 3; ++a) {
            moved.min[a] = std::min(moved.min[a], v[a]);
            moved.max[a] = std::max(moved.max[a], v[a]);
        }
    }
    checked.report.bounds = moved;
    checked.report.volume *= factor * factor * factor;
    checked.report.area *= factor * factor;
    checked.report.thickness_p01 *= factor;
}

SurfacePointer surface_of(const CheckedMesh& checked, int dimensions) {
    SurfacePointer body = make_mesh(checked.mesh, checked.report);
    if (dimensions == 3) return body;
    const auto pieces = slice(checked.mesh);
    if (pieces.empty()) throw Nowhere{};
    // Just below the plane, where slice() cuts: a face on the plane itself has no clear side.
    const double below = -1e-9 * length(checked.report.bounds.max - checked.report.bounds.min);
    return make_cross_section(pieces, [body, below](const Vec3& x) {
        return body->nearest({x[0], x[1], below}).distance < 0;
    });
}

// Parts that overlap are joined; where some are cavities in others, the winding number determines the inside.
void fill_overlapping(const CheckedMesh& checked, int dimensions, Solid& out) {
    auto parts = split(checked);
    if (std::ranges::any_of(parts, [](const CheckedMesh& part) { return part.report.volume <= 0; }) ||
        parts.size() == 1) {
        out.surface = surface_of(checked, dimensions);
        out.crosses_itself = true;
        return;
    }
    for (const CheckedMesh& part : parts) {
        Solid& solid = out.parts.emplace_back();
        try {
            solid.surface = surface_of(part, dimensions);
        } catch (const Nowhere&) { // a part that does not meet the plane
        }
    }
}

void fill_mesh(const Shape& shape, int dimensions, const ShapePose& outer_pose, SolidNotes& notes, Solid& out) {
    if (shape.size <= 0) require_positive(shape, "scale", shape.scale);
    CheckedMesh checked = load_closed_mesh(shape.file, shape.where);
    pose_mesh(checked, shape, outer_pose);
    notes.meshes.push_back(checked.report);
    if (checked.report.overlaps()) return fill_overlapping(checked, dimensions, out);
    if (dimensions == 3) notes.moments = moments_of(checked.mesh);
    out.surface = surface_of(checked, dimensions);
}

void require_valid(const Shape& shape) {
    require_finite(shape, "translation", shape.translation);
    if (shape.rotation_angle != 0) require_direction(shape, "rotation_axis", shape.rotation_axis);
    if (!std::isfinite(shape.rotation_angle))
        reject_value(shape, "the rotation angle is not finite", "", "give an angle");
}

SurfacePointer primitive_of(const Shape& shape, int dimensions, const ShapePose& outer_pose) {
    if (shape.kind == ShapeKind::box) return box_of(shape, dimensions, outer_pose);
    if (shape.kind == ShapeKind::plane) return plane_of(shape, dimensions, outer_pose);
    return round_of(shape, dimensions, outer_pose);
}

Solid solid_of(const Shape& shape, int dimensions, const ShapePose& outer_pose, SolidNotes& notes);

// `outer_pose` is that of the shape that has the parts.
Solid joined_of(const Shape& shape, int dimensions, const ShapePose& outer_pose, SolidNotes& notes) {
    require_finite(shape, "centre", shape.centre);
    const ShapePose inner = outer_pose.after(pose_of(shape));
    Solid out;
    out.join = shape.kind == ShapeKind::unite ? Solid::Join::unite : Solid::Join::intersect;
    for (const Shape& part : shape.parts) {
        out.parts.push_back(solid_of(part, dimensions, inner, notes));
        // A without B is what A and the outside of B have in common.
        if (shape.kind == ShapeKind::subtract && out.parts.size() > 1) out.parts.back().inverted ^= true;
    }
    notes.moments.reset();
    return out;
}

Solid solid_of(const Shape& shape, int dimensions, const ShapePose& outer_pose, SolidNotes& notes) {
    require_valid(shape);
    Solid out;
    if (!shape.parts.empty()) {
        out = joined_of(shape, dimensions, outer_pose, notes);
    } else {
        try {
            if (shape.kind == ShapeKind::mesh) {
                fill_mesh(shape, dimensions, outer_pose, notes, out);
            } else {
                out.surface = primitive_of(shape, dimensions, outer_pose);
            }
        } catch (const Nowhere&) { // a solid without a surface
        }
    }
    out.inverted = shape.inverted;
    return out;
}

} // namespace

Solid make_solid(const Shape& shape, int dimensions, SolidNotes& notes) {
    return solid_of(shape, dimensions, {}, notes);
}

} // namespace treacle::scene
