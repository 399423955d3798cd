#include "base/options/options.hpp"
#include "scene/names.hpp"
#include "scene/pivot.hpp"
#include "scene/scene.hpp"
#include "scene/shape_options.hpp"

#include <algorithm>

namespace treacle::scene {

void Keyframe::declare(Declaration& d) {
    d.number("time", time, unit::time, range_at_least(0), "When the body is at this place.");
    d.required("time");
    d.vec3("translation", translation, unit::length, "Shift from the initial place.");
    d.direction("rotation_axis", rotation_axis, "Axis of the rotation, of any length.");
    d.number("rotation_angle", rotation_angle, unit::angle, range_any(), "Rotation from the initial orientation.");
    const bool leaves_plane = rotation_angle != 0 && (rotation_axis[0] != 0 || rotation_axis[1] != 0);
    d.check(!d.plane_vectors() || !leaves_plane, "rotation_axis",
        {"must be z", "the scene is plane, and would be left by what turns about x or y",
            "leave it out, or write dimensions: 3"});
}

namespace {

const std::vector<std::string> degrees{"x", "y", "z", "rotation_x", "rotation_y", "rotation_z"};

bool at_start(const Keyframe& frame) { return frame.translation == Vec3{0, 0, 0} && frame.rotation_angle == 0; }

void check_mass(Declaration& d, const Body& body) {
    const bool dynamic = body.kind == BodyKind::dynamic;
    d.check(!dynamic || body.density > 0 || body.mass > 0, "density",
        {"must be > 0 for a dynamic body, unless its mass is given", "its inertia follows from it",
            "wood is about 600 kg/m3"});
    d.check(!dynamic || body.density == 0 || body.mass == 0, "mass",
        {"must not be given beside the density", "the one follows from the other", "remove one of them"});
    for (const auto& [key, value] : {std::pair("density", body.density), std::pair("mass", body.mass)}) {
        d.check(dynamic || value == 0, key,
            {"has no effect", "the body is not dynamic", "write kind: dynamic or remove it"});
    }
    d.check(dynamic || body.locked == std::array<bool, 6>{}, "locked",
        {"has no effect", "the body is not dynamic", "write kind: dynamic or remove it"});
}

void check_keyframes(Declaration& d, const Body& body) {
    const bool kinematic = body.kind == BodyKind::kinematic;
    const bool drifts = body.velocity != Vec3{0, 0, 0} || body.angular_velocity != Vec3{0, 0, 0};
    d.check(!kinematic || drifts || !body.keyframes.empty(), "keyframes",
        {"must not be empty for a kinematic body without velocities", "they are its motion",
            "add them, a velocity or an angular_velocity, or write kind: static"});
    d.check(!kinematic || !drifts || body.keyframes.empty(), "keyframes",
        {"must not be given beside velocities", "a kinematic body follows the one or the other", "remove one of them"});
    d.check(kinematic || body.keyframes.empty(), "keyframes",
        {"have no effect", "the body is not kinematic", "write kind: kinematic or remove them"});
    d.check(kinematic || !body.pivot, "pivot",
        {"has no effect", "the body is not kinematic", "write kind: kinematic or remove it"});
    const auto not_later = [](const Keyframe& a, const Keyframe& b) { return b.time <= a.time; };
    d.check(std::ranges::adjacent_find(body.keyframes, not_later) == body.keyframes.end(), "keyframes",
        {"must have increasing times", "the body moves from one to the next", "sort them"});
    d.check(body.keyframes.empty() || body.keyframes.front().time > 0 || at_start(body.keyframes.front()), "keyframes",
        {"must leave the body in its place at time 0", "the run starts with the body where its shape is",
            "move the shape, or give the first keyframe a later time"});
}

void check_motion(Declaration& d, const Body& body) {
    check_mass(d, body);
    check_keyframes(d, body);
    const std::pair<const char*, const Vec3*> velocities[] = {
        {"velocity", &body.velocity}, {"angular_velocity", &body.angular_velocity}};
    for (const auto& [key, value] : velocities) {
        d.check(body.kind != BodyKind::fixed || *value == Vec3{0, 0, 0}, key,
            {"has no effect", "a static body rests", "write kind: dynamic or kind: kinematic"});
    }
}

void declare_locked(Declaration& d, Body& body) {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < degrees.size(); ++k) {
        if (body.locked[k]) names.push_back(degrees[k]);
    }
    d.texts("locked", names, "Degrees of freedom that a dynamic body does not have.", degrees);
    for (std::size_t k = 0; k < degrees.size(); ++k) {
        body.locked[k] = std::ranges::find(names, degrees[k]) != names.end();
    }
}

} // namespace

void Body::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    declare_name(d, name, "How messages, overrides and results call it.");
    d.choice<BodyKind>("kind", kind,
        {{"static", BodyKind::fixed}, {"kinematic", BodyKind::kinematic}, {"dynamic", BodyKind::dynamic}},
        "Static bodies rest, kinematic ones follow their keyframes or velocities, dynamic ones the forces on "
        "them.");
    d.block("shape", shape, "The solid's shape.");
    d.required("shape");
    d.number("density", density, unit::density, range_at_least(0), "Mass per volume of a dynamic body.");
    d.number("mass", mass, unit::mass, range_at_least(0),
        "Mass of a dynamic body in place of its density; in a plane scene per metre of depth.");
    d.choice<Slip>("slip", slip,
        {{"free_slip", Slip::free_slip}, {"no_slip", Slip::no_slip}, {"slip_length", Slip::slip_length}},
        "How the surface holds viscous liquid.");
    d.number("slip_length", slip_length, unit::length, range_at_least(0),
        "With slip: slip_length, the depth behind the surface at which the velocity would be the body's.");
    d.number("skin_friction", skin_friction, unit::none, range_between(0, 1),
        "Coefficient c_f of turbulent flow along the surface; see domain.boundaries.x_min.skin_friction.");
    d.check((slip == Slip::slip_length) == (slip_length > 0), "slip_length",
        {"must be > 0 with slip: slip_length, and only then", "0 is no_slip", "give both or none"});
    d.vec3("velocity", velocity, unit::velocity,
        "Velocity of a dynamic body at the start, or of a kinematic one all the time.");
    d.vec3("angular_velocity", angular_velocity, unit::angular_velocity,
        "Angular velocity of a dynamic body at the start, or of a kinematic one all the time.", VectorKind::turning);
    d.list("keyframes", keyframes,
        "Motion of a kinematic body, in the order of time: from one to the next at constant velocity and about "
        "a fixed axis, from its initial place at time 0, at rest after the last. Angles of keyframes with the "
        "same axis are interpolated as they are, over several turns; otherwise the shorter way is taken.");
    declare_pivot(d, pivot, "A point of the body where it is at the start.",
        "What a kinematic body turns about; without it its centre of mass.");
    declare_locked(d, *this);
    d.number("restitution", restitution, unit::none, range_between(0, 1),
        "Of contacts: velocity after over velocity before; of two bodies the larger one counts.");
    d.number("friction", friction, unit::none, range_at_least(0),
        "Of contacts: Coulomb's coefficient; of two bodies the geometric mean counts.");
    check_motion(d, *this);
}

} // namespace treacle::scene
