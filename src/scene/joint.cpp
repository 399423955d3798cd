#include "base/options/options.hpp"
#include "scene/names.hpp"
#include "scene/scene.hpp"

namespace treacle::scene {

void Joint::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    declare_name(d, name, "How messages call it.");
    d.choice<JointKind>("kind", kind,
        {{"hinge", JointKind::hinge}, {"ball", JointKind::ball}, {"slider", JointKind::slider}},
        "Rotation about an axis through a point, rotation about a point, or motion along an axis without "
        "rotation.");
    d.text("body", body, "Name of the dynamic body that it holds.");
    d.required("body");
    d.text("to", to, "Name of the body that it is held by, of any kind; without it the world.");
    d.vec3("point", point, unit::length, "A point of the joint, where both bodies are at the start.");
    d.required("point");
    d.direction("axis", axis, "Axis of a hinge or a slider, of any length; in plane scenes a hinge's is z.");
    const bool standard = axis == Vec3{0, 0, 1};
    const bool plane = d.plane_vectors();
    d.check(!d.parsing() || kind == JointKind::ball || d.given("axis") || (plane && kind == JointKind::hinge), "axis",
        {"must be given", "a hinge turns about it and a slider moves along it", "write for instance axis: [1, 0, 0]"});
    d.check(kind != JointKind::ball || standard, "axis",
        {"has no effect", "a ball joint turns about all axes", "write kind: hinge or remove it"});
    d.check(!plane || kind != JointKind::hinge || (axis[0] == 0 && axis[1] == 0), "axis",
        {"must be z", "the scene is plane", "leave it out"});
    d.check(!plane || kind != JointKind::slider || axis[2] == 0 || !d.given("axis"), "axis",
        {"must lie in the plane", "the scene is plane", "write for instance axis: [1, 0, 0]"});
}

} // namespace treacle::scene
