#include "base/options/options.hpp"
#include "scene/names.hpp"
#include "scene/scene.hpp"

namespace treacle::scene {

namespace {

using Alternative = Declaration::Alternative;

const Range positive_length = range_above(0).because("it is a length of the opening", "write for instance 5 mm");

void declare_position(Declaration& d, Inlet& inlet) {
    d.vec3("centre", inlet.centre, unit::length, "Middle of the opening.");
    d.required("centre");
    d.direction("direction", inlet.direction, "Where the liquid flows to, of any length: the normal of the opening.",
        VectorKind::in_plane);
    d.required("direction");
}

void declare_disc(Declaration& d, Inlet& inlet) {
    declare_position(d, inlet);
    d.number(
        "radius", inlet.radius, unit::length, positive_length, "Radius of the opening; in the plane half its width.");
    d.required("radius");
}

void declare_rectangle(Declaration& d, Inlet& inlet) {
    declare_position(d, inlet);
    d.number("width", inlet.width, unit::length, positive_length, "Extent of the opening along `along`.");
    d.required("width");
    const bool plane = d.plane_vectors();
    d.number("height", inlet.height, unit::length, plane || !d.parsing() ? range_at_least(0) : positive_length,
        "Extent of the opening across that; in the plane there is none.");
    if (!plane) d.required("height");
    d.check(!plane || inlet.height == 0, "height", {"has no effect", "the scene is plane", "remove it"});
    d.vec3("along", inlet.along, unit::none,
        "Direction of the width, of any length, of which what is along `direction` is left out; by default a "
        "coordinate axis.",
        VectorKind::in_space);
}

} // namespace

void Inlet::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    declare_name(d, name, "How messages call it.");
    d.text("liquid", liquid, "Name of the liquid that flows in; may be left out when there is one only.");
    d.one_of<InletShape>(shape,
        {{InletShape::disc,
             Alternative{"disc", [this](Declaration& m) { declare_disc(m, *this); }, "A round opening."}},
            {InletShape::rectangle, Alternative{"rectangle", [this](Declaration& m) { declare_rectangle(m, *this); },
                                        "A rectangular opening."}}});
    const Range flow = range_at_least(0).because("the liquid flows in", "turn `direction` round");
    d.number("flow_rate", flow_rate, unit::volume_flow, flow,
        "Volume in a second, which is kept exactly; in the plane for a depth of 1 m. This, or `velocity`.");
    d.number("velocity", velocity, unit::velocity, flow, "Speed along `direction`. This, or `flow_rate`.");
    d.check(flow_rate > 0 || velocity > 0, "flow_rate",
        {"must be > 0, or a velocity be given", "nothing would flow in", "write for instance flow_rate: 10 ml/s"});
    d.check(flow_rate == 0 || velocity == 0, "velocity",
        {"cannot go with flow_rate", "the one follows from the other", "leave one of them out"});
    d.number("start", start, unit::time, range_at_least(0), "When the liquid's front goes through the opening.");
    d.number("end", end, unit::time, range_at_least(0),
        "When its end goes through the opening; 0: not before the run ends.");
    d.check(end == 0 || end > start, "end", {"must be later than start", "nothing would flow in", "0 is never"});
}

void Outlet::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    declare_name(d, name, "How messages call it.");
    const auto box = [this](Declaration& m) {
        m.vec3("min", min, unit::length, "Lower corner.");
        m.vec3("max", max, unit::length, "Upper corner.");
        m.required("min");
        m.required("max");
        for (std::size_t k = 0; k < (m.plane_vectors() ? 2u : 3u); ++k) {
            m.check(min[k] < max[k], "max",
                {std::string("must be greater than min in ") + "xyz"[k], "the box has no volume",
                    "swap the corners or make it thicker"});
        }
    };
    const auto half_space = [this](Declaration& m) {
        m.vec3("point", point, unit::length, "A point of the plane.");
        m.direction("normal", normal, "Direction away from what is taken out, of any length.", VectorKind::in_plane);
        m.required("point");
        m.required("normal");
    };
    d.one_of<OutletShape>(shape,
        {{OutletShape::box, Alternative{"box", box, "What is in a box is taken out."}},
            {OutletShape::half_space, Alternative{"half_space", half_space, "What is behind a plane is taken out."}}});
}

} // namespace treacle::scene
