#include "app/study/flow_lengths.hpp"

#include "app/input/table_text.hpp"
#include "app/setup/estimates.hpp"
#include "app/setup/geometry.hpp"
#include "identify/material/first_guess.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace treacle::app {

namespace {
constexpr double usual_tension = 0.05; // [N/m] oils, syrups and pastes have 0.02 to 0.08
constexpr double least_bond = 10, least_cells = 4;

struct Hole {
    double radius = std::numeric_limits<double>::infinity(); // [m]
    double height = 0;                                       // [m] of its middle, against gravity
};

// The narrowest round hole in a shape; an infinite one where there is none.
Hole narrowest_hole(const scene::Shape& shape, std::size_t up, bool taken_out = false) {
    Hole out;
    if (taken_out && shape.kind == scene::ShapeKind::cylinder) out = {shape.radius, shape.centre[up]};
    for (std::size_t i = 0; i < shape.parts.size(); ++i) {
        const bool out_of = shape.kind == scene::ShapeKind::subtract ? i > 0 : taken_out;
        const auto part = narrowest_hole(shape.parts[i], up, out_of);
        if (part.radius < out.radius) out = part;
    }
    return out;
}

// Radius of a thread after a free fall: a^2 v is kept [m].
double fallen_radius(double radius, double speed, double fall) {
    return radius * std::sqrt(speed / std::sqrt(speed * speed + 2 * identify::gravity * std::max(0.0, fall)));
}

// Width [m] of a channel along x: between walls at both ends of y, in two dimensions 1. None where the liquid spreads all round.
std::optional<double> channel_width(const scene::Domain& domain) {
    if (domain.dimensions == 2) return 1;
    const bool walls =
        domain.faces[2].kind == scene::BoundaryKind::wall && domain.faces[3].kind == scene::BoundaryKind::wall;
    return walls ? std::optional(domain.max[1] - domain.min[1]) : std::nullopt;
}

// Mean thickness of all the liquid at the end of the run, as a layer over a floor [m]; 0 where it cannot be determined.
double spread_thickness(const Input& input, const Geometry& geometry) {
    const auto& scene = input.scene;
    const auto& liquid = scene.liquids.front();
    double volume = 0;
    for (const auto& regions : geometry.liquids) {
        for (const auto& region : regions) volume += region.volume();
    }
    const double nu = liquid.viscosity / liquid.density;
    const bool closed = scene.domain.faces[1].kind == scene::BoundaryKind::wall; // towards x
    if (closed || !std::isfinite(volume) || !(volume > 0) || !(nu > 0)) return 0;
    if (const auto width = channel_width(scene.domain)) {
        const double area = volume / *width;
        return area / identify::plane_front(nu, area, scene.time.end);
    }
    const double radius = identify::round_front(nu, volume, scene.time.end);
    return volume / (std::numbers::pi * radius * radius);
}
} // namespace

std::vector<FlowLength> flow_lengths(const Input& input) {
    const auto& scene = input.scene;
    const auto geometry = build_geometry(input);
    const auto counts = estimate_particles(input, geometry);
    const double height = estimate_run(input, geometry, counts.liquid, counts.solid).length;
    const auto& liquid = scene.liquids.front();
    const std::size_t up = scene.domain.dimensions == 2 ? 1 : 2;
    std::vector<FlowLength> out;
    bool holes = false;
    for (const auto& body : scene.bodies) {
        const auto hole = narrowest_hole(body.shape, up);
        if (!std::isfinite(hole.radius) || liquid.viscosity <= 0) continue;
        holes = true;
        out.push_back({"hole of " + body.name, hole.radius, 2 * hole.radius});
        // Its speed by the loss at the entrance and a length of a diameter.
        const double flow =
            identify::outflow({liquid.density, hole.radius, 2 * hole.radius, height, 1}) / liquid.viscosity;
        const double speed = flow / (std::numbers::pi * hole.radius * hole.radius);
        const double thread = fallen_radius(hole.radius, speed, hole.height - scene.domain.min[up]);
        out.push_back({"thread below it, falling freely", thread, 2 * thread});
    }
    for (const auto& inlet : scene.inlets) {
        if (inlet.shape != scene::InletShape::disc || inlet.velocity <= 0) continue;
        const double thread = fallen_radius(inlet.radius, inlet.velocity, inlet.centre[up] - scene.domain.min[up]);
        out.push_back({"thread of " + inlet.name + ", falling freely", thread, 2 * thread});
    }
    if (height > 0) out.push_back({"layer at the start", height, height});
    const double thickness = holes || !scene.inlets.empty() ? 0 : spread_thickness(input, geometry);
    if (thickness > 0)
        out.push_back({"layer at the end, spread out", std::min(thickness, height), std::min(thickness, height)});
    return out;
}

std::vector<LabelledLine> flow_length_lines(const Input& input) {
    const auto& liquid = input.scene.liquids.front();
    const double spacing = input.scene.domain.spacing;
    const double tension = liquid.surface_tension > 0 ? liquid.surface_tension : usual_tension;
    const double capillary = std::sqrt(tension / (liquid.density * identify::gravity));
    std::vector<LabelledLine> out;
    out.emplace_back(
        "capillary length", short_number(1e3 * capillary) + " mm, " + short_number(capillary / spacing) +
                                " cells, with a surface tension of " + short_number(tension) + " N/m" +
                                (liquid.surface_tension > 0 ? "" : ", that of many liquids: the scene has none"));
    std::vector<LabelledLine> warnings;
    for (const auto& one : flow_lengths(input)) {
        const double bond = std::pow(one.length / capillary, 2), cells = one.across / spacing;
        out.emplace_back(one.name, short_number(1e3 * one.across) + " mm, " + short_number(cells) +
                                       " cells across, Bond number " + short_number(bond));
        if (bond < least_bond) {
            warnings.emplace_back(
                "", "warning: " + one.name + ": a Bond number of " + short_number(bond) +
                        " is below 10: surface tension matters there" +
                        (liquid.surface_tension > 0 ? "" : "; give liquids." + liquid.name + ".surface_tension") +
                        ", or leave those frames out");
        }
        if (cells < least_cells) {
            warnings.emplace_back(
                "", "warning: " + one.name + ": " + short_number(cells) +
                        " cells across are fewer than 4: refine domain.spacing, or leave those frames out");
        }
    }
    out.insert(out.end(), warnings.begin(), warnings.end());
    return out;
}

} // namespace treacle::app
