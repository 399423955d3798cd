#include "base/options.hpp"
#include "scene/materials.hpp"
#include "scene/names.hpp"
#include "scene/scene.hpp"
#include "scene/shape_options.hpp"

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
    const bool newtonian = liquid.rheology.law == ShearLaw::newtonian;
    d.check(newtonian || liquid.viscosity > 0, "viscosity",
            {"must be > 0 with a rheology", "it is the law's viscosity at rest (carreau, cross) or at a shear rate of 1/s",
             "give the liquid's viscosity"});
    d.check(newtonian || liquid.rheology.infinite_viscosity <= liquid.viscosity, "rheology",
            {"infinite_viscosity must be at most viscosity", "these liquids thin with the shear rate", "swap the two"});
    d.check(newtonian || liquid.viscosity_profile.points.empty(), "viscosity_profile",
            {"cannot go with a rheology", "both would say what the viscosity is", "make it two liquids of the same density"});
    d.check(newtonian || liquid.viscosity_regions.empty(), "viscosity_regions",
            {"cannot go with a rheology", "both would say what the viscosity is", "make it two liquids of the same density"});
}

} // namespace

void Liquid::declare(Declaration& d) {
    if (d.parsing()) where = d.place();
    declare_name(d, name, "How messages, overrides and results call it; by default its material.");
    d.choice(
        "material", material, material_choices(),
        "Preset of `treacle materials`, for the density, viscosity and surface tension that are not given.");
    const auto* preset = find_material(material);
    if (preset && d.parsing()) {
        density = preset->density;
        viscosity = preset->viscosity;
        surface_tension = preset->surface_tension;
    }
    d.number(
        "density", density, unit::density,
        range_above(0).because("it is mass per volume", "water is about 1000 kg/m3, honey about 1400 kg/m3"),
        "Mass per volume.");
    d.number("viscosity", viscosity, unit::viscosity_of(density),
             range_at_least(0).because("a Newtonian viscosity is positive",
                                       "honey is about 10 Pa s, water 0.001 Pa s"),
             "Dynamic viscosity; a kinematic one is accepted with its unit and multiplied by the density.");
    declare_variation(d, *this);
    d.number("surface_tension", surface_tension, unit::surface_tension,
             range_at_least(0).because("a liquid with a negative one would fly apart", "water has 72 mN/m"),
             "Surface tension against air.");
    d.list("shapes", shapes, "Where the liquid is at the start: the union of these shapes. May be left out when an inlet pours it.");
    d.boolean("around_bodies", around_bodies,
              "Whether the shapes may reach into bodies, the liquid being left out there; otherwise that is an error.");
    d.vec3("velocity", velocity, unit::velocity, "Velocity at the start.");
}

} // namespace treacle::scene
