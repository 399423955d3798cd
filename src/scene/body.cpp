#include "base/options.hpp"
#include "scene/names.hpp"
#include "scene/scene.hpp"
#include "scene/shape_options.hpp"

#include <algorithm>

namespace treacle::scene {

void Keyframe::declare(Declaration& d) {
    d.number("time", time, unit::time, range_at_least(0), "When the body is at this place.");
    d.required("time");
    d.vec3("translation", translation, unit::length, "Shift from the initial place.");
    d.direction("rotation_axis", rotation_axis, "Axis of the rotation, of any length.");
    d.number("rotation_angle", rotation_angle, unit::angle, range_any(),
             "Rotation from the initial orientation.");
}

namespace {

void check_motion(Declaration& d, const Body& body) {
    const bool dynamic = body.kind == BodyKind::dynamic;
    const bool kinematic = body.kind == BodyKind::kinematic;
    d.check(!dynamic || body.density > 0, "density",
            {"must be > 0 for a dynamic body", "its mass follows from it", "wood is about 600 kg/m3"});
    d.check(dynamic || body.density == 0, "density",
            {"has no effect", "the body is not dynamic", "write kind: dynamic or remove it"});
    const std::pair<const char*, const Vec3*> velocities[] = {{"velocity", &body.velocity},
                                                              {"angular_velocity", &body.angular_velocity}};
    for (const auto& [key, value] : velocities) {
        d.check(dynamic || *value == Vec3{0, 0, 0}, key,
                {"has no effect", "only a dynamic body starts with a velocity",
                 "write kind: dynamic, or kind: kinematic with keyframes"});
    }
    d.check(
        !kinematic || !body.keyframes.empty(), "keyframes",
        {"must not be empty for a kinematic body", "they are its motion", "add them or write kind: static"});
    d.check(kinematic || body.keyframes.empty(), "keyframes",
            {"have no effect", "the body is not kinematic", "write kind: kinematic or remove them"});
    const auto not_later = [](const Keyframe& a, const Keyframe& b) { return b.time <= a.time; };
    d.check(std::ranges::adjacent_find(body.keyframes, not_later) == body.keyframes.end(), "keyframes",
            {"must have increasing times", "the body moves from one to the next", "sort them"});
}

} // namespace

void Body::declare(Declaration& d) {
    if (d.parsing()) where = d.place();
    declare_name(d, name, "How messages, overrides and results call it.");
    d.choice<BodyKind>(
        "kind", kind,
        {{"static", BodyKind::fixed}, {"kinematic", BodyKind::kinematic}, {"dynamic", BodyKind::dynamic}},
        "Static bodies rest, kinematic ones follow their keyframes, dynamic ones the forces on them.");
    d.block("shape", shape, "The solid's shape.");
    d.required("shape");
    d.number("density", density, unit::density, range_at_least(0), "Mass per volume of a dynamic body.");
    d.choice<Slip>(
        "slip", slip,
        {{"free_slip", Slip::free_slip}, {"no_slip", Slip::no_slip}, {"slip_length", Slip::slip_length}},
        "How the surface holds viscous liquid.");
    d.number(
        "slip_length", slip_length, unit::length, range_at_least(0),
        "With slip: slip_length, the depth behind the surface at which the velocity would be the body's.");
    d.number("skin_friction", skin_friction, unit::none, range_between(0, 1),
             "Coefficient c_f of turbulent flow along the surface; see domain.boundaries.x_min.skin_friction.");
    d.check((slip == Slip::slip_length) == (slip_length > 0), "slip_length",
            {"must be > 0 with slip: slip_length, and only then", "0 is no_slip", "give both or none"});
    d.vec3("velocity", velocity, unit::velocity, "Velocity at the start of a dynamic body.");
    d.vec3("angular_velocity", angular_velocity, unit::angular_velocity,
           "Angular velocity at the start of a dynamic body.", VectorKind::in_space);
    d.list("keyframes", keyframes, "Motion of a kinematic body, in the order of time.");
    check_motion(d, *this);
}

} // namespace treacle::scene
