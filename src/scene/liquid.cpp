#include "base/options/options.hpp"
#include "scene/materials.hpp"
#include "scene/names.hpp"
#include "scene/pivot.hpp"
#include "scene/scene.hpp"
#include "scene/shape_options.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::scene {

namespace {

std::vector<std::pair<std::string, std::string>> material_choices() {
    std::vector<std::pair<std::string, std::string>> choices{{"none", "none"}};
    for (const auto& material : materials()) {
        choices.emplace_back(std::string(material.name), std::string(material.name));
    }
    return choices;
}

// Viscosities that differ from particle to particle.
void declare_variation(Declaration& d, Liquid& liquid) {
    d.block("rheology", liquid.rheology, "How the viscosity depends on the shear rate.", "law");
    d.block("viscosity_profile", liquid.viscosity_profile, "A viscosity that depends on where particles start.");
    d.list("viscosity_regions", liquid.viscosity_regions,
        "Parts of the liquid with a viscosity of their own: of particles that start in them, which keep it wherever "
        "they go. Where regions overlap the last one counts.");
    const bool newtonian = liquid.rheology.law == ViscosityModelKind::newtonian;
    d.check(newtonian || liquid.viscosity > 0, "viscosity",
        {"must be > 0 with a rheology", "it is the law's viscosity at rest (carreau, cross) or at a shear rate of 1/s",
            "give the liquid's viscosity"});
    d.check(newtonian || liquid.rheology.infinite_shear_viscosity <= liquid.viscosity, "rheology",
        {"infinite_shear_viscosity must be at most viscosity", "these liquids thin with the shear rate",
            "swap the two"});
    d.check(newtonian || liquid.viscosity_profile.points.empty(), "viscosity_profile",
        {"cannot go with a rheology", "both would say what the viscosity is",
            "make it two liquids of the same density"});
    d.check(newtonian || liquid.viscosity_regions.empty(), "viscosity_regions",
        {"cannot go with a rheology", "both would say what the viscosity is",
            "make it two liquids of the same density"});
}

// Motion at the start.
void declare_motion(Declaration& d, Liquid& liquid) {
    d.vec3("velocity", liquid.velocity, unit::velocity,
        "Velocity at the start; with an angular velocity or a gradient that of the pivot.");
    d.vec3("angular_velocity", liquid.angular_velocity, unit::angular_velocity,
        "Angular velocity at the start, about the pivot.", VectorKind::turning);
    d.block("velocity_gradient", liquid.velocity_gradient,
        "Velocity at the start that grows linearly with the distance from the pivot, besides `velocity` and "
        "`angular_velocity`: for instance x: [0, 2, 0] is a shear flow along x of 2 m/s per metre of y.");
    double trace = 0, largest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        trace += liquid.velocity_gradient.rows[i][i];
        for (const double change : liquid.velocity_gradient.rows[i]) largest = std::max(largest, std::abs(change));
    }
    d.check(std::abs(trace) <= 1e-6 * largest, "velocity_gradient",
        {"must have a divergence of 0: the sum of x[0], y[1] and z[2]",
            "the liquid keeps its volume, and the first pressure would change the velocity",
            "a jet that stretches along z at 2 /s has x: [-1, 0, 0], y: [0, -1, 0], z: [0, 0, 2]"});
    declare_pivot(d, liquid.pivot, "A point, whether liquid is there or not.",
        "Where the velocity at the start is `velocity`; without it the centre of the shapes together.");
    d.check(!liquid.sheared() || !liquid.shapes.empty(), "shapes",
        {"must be given with angular_velocity or velocity_gradient", "those are of the liquid at the start",
            "add a shape, or remove them"});
}

} // namespace

void Liquid::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    declare_name(d, name, "How messages, overrides and results call it; by default its material.");
    d.choice("material", material, material_choices(),
        "Preset of `treacle materials`, for the density, viscosity and surface tension that are not given.");
    const auto* preset = find_material(material);
    if (preset && d.parsing()) {
        density = preset->density;
        viscosity = preset->viscosity;
        surface_tension = preset->surface_tension;
    }
    d.number("density", density, unit::density,
        range_above(0).because("it is mass per volume", "water is about 1000 kg/m3, honey about 1400 kg/m3"),
        "Mass per volume.");
    d.number("viscosity", viscosity, unit::viscosity_of(density),
        range_at_least(0).because("a Newtonian viscosity is positive", "honey is about 10 Pa s, water 0.001 Pa s"),
        "Dynamic viscosity; a kinematic one is accepted with its unit and multiplied by the density.");
    declare_variation(d, *this);
    d.number("surface_tension", surface_tension, unit::surface_tension,
        range_at_least(0).because("a liquid with a negative one would fly apart", "water has 72 mN/m"),
        "Surface tension against air.");
    d.list("shapes", shapes,
        "Where the liquid is at the start: the union of these shapes. May be left out when an inlet pours it.");
    d.boolean("subtract_bodies", subtract_bodies,
        "Whether the shapes may reach into bodies, the liquid being left out there; otherwise that is an error.");
    declare_motion(d, *this);
}

void VelocityGradient::declare(Declaration& d) {
    const char* names[] = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
        d.vec3(names[i], rows[i], unit::frequency,
            std::string("Change of the velocity's ") + names[i] + " component per length along x, y and z.");
    }
    d.check(!d.plane_vectors() || rows[2] == Vec3{0, 0, 0}, "z",
        {"must not be given", "the scene is plane", "leave it out"});
}

std::array<Vec3, 3> Liquid::initial_gradient() const {
    auto out = velocity_gradient.rows;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        out[i][k] += angular_velocity[j]; // (w x r)_i = w_j r_k - w_k r_j
        out[i][j] -= angular_velocity[k];
    }
    return out;
}

Vec3 Liquid::initial_velocity(const Vec3& x, const Vec3& centre) const {
    Vec3 out = velocity;
    const auto gradient = initial_gradient();
    for (std::size_t i = 0; i < 3; ++i) out[i] += dot(gradient[i], x - centre);
    return out;
}

bool Liquid::sheared() const {
    return std::ranges::any_of(initial_gradient(), [](const Vec3& row) { return row != Vec3{0, 0, 0}; });
}

} // namespace treacle::scene
