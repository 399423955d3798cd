#include "base/options/options.hpp"
#include "scene/scene.hpp"
#include "scene/shape_options.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::scene {

namespace {
const Range not_negative =
    range_at_least(0).because("a Newtonian viscosity is positive", "honey is about 10 Pa s, water 0.001 Pa s");
} // namespace

void Rheology::declare(Declaration& d) {
    d.choice("law", law,
        {{"newtonian", ViscosityModelKind::newtonian}, {"power_law", ViscosityModelKind::power_law},
            {"carreau", ViscosityModelKind::carreau}, {"cross", ViscosityModelKind::cross},
            {"herschel_bulkley", ViscosityModelKind::herschel_bulkley}},
        "Viscosity mu at the shear rate G, K being the liquid's `viscosity`: K; K (G s)^(n-1); mu_inf + "
        "(K - mu_inf) "
        "(1 + (t G)^2)^((n-1)/2); mu_inf + (K - mu_inf) / (1 + (t G)^n); K (G s)^(n-1) + yield stress / "
        "G (1 - exp(-m G)).");
    const bool plain = law == ViscosityModelKind::newtonian, yields = law == ViscosityModelKind::herschel_bulkley;
    const bool plateaus = law == ViscosityModelKind::carreau || law == ViscosityModelKind::cross,
               powers = yields || law == ViscosityModelKind::power_law;
    d.number("exponent", exponent, unit::none, range_above_to(0, 10),
        "n of the law; of `herschel_bulkley` 1 is a Bingham fluid.");
    d.number("infinite_shear_viscosity", infinite_shear_viscosity, unit::viscosity, range_at_least(0),
        "mu_inf of `carreau` and `cross`, at high shear rates.");
    d.number("relaxation_time", relaxation_time, unit::time, range_at_least(0), "t of `carreau` and `cross`.");
    d.number("yield_stress", yield_stress, unit::pressure, range_at_least(0),
        "Shear stress at which `herschel_bulkley` flows.");
    d.number("regularisation_time", regularisation_time, unit::time, range_above(0),
        "m of `herschel_bulkley`: below the shear rate 1/m it creeps, with a viscosity of m times the "
        "yield stress.");
    d.number("min_shear_rate", min_shear_rate, unit::frequency, range_above(0),
        "Of `power_law` and `herschel_bulkley`: at smaller rates the viscosity of the power law stays "
        "what it is.");
    const auto only = [&](bool read, bool given, const char* key, const char* laws) {
        d.check(
            read || !given, key, {"has no effect", std::string("it belongs to ") + laws, "remove it or change law"});
    };
    const Rheology standard;
    only(!plain, exponent != 1, "exponent", "every law but newtonian");
    only(plateaus, infinite_shear_viscosity != 0, "infinite_shear_viscosity", "carreau and cross");
    only(plateaus, relaxation_time != 0, "relaxation_time", "carreau and cross");
    only(yields, yield_stress != 0, "yield_stress", "herschel_bulkley");
    only(yields, regularisation_time != standard.regularisation_time, "regularisation_time", "herschel_bulkley");
    only(powers, min_shear_rate != standard.min_shear_rate, "min_shear_rate", "power_law and herschel_bulkley");
    d.check(!plateaus || relaxation_time > 0, "relaxation_time",
        {"must be > 0", "one over it is the shear rate at which the viscosity begins to fall", "give it"});
}

void ViscosityRegion::declare(Declaration& d) {
    d.block("shape", shape, "Which particles, by where they are at the start.");
    d.required("shape");
    d.number("viscosity", viscosity, unit::viscosity, not_negative, "Their dynamic viscosity.");
    d.required("viscosity");
}

void ViscosityPoint::declare(Declaration& d) {
    d.number("at", at, unit::length, range_any(), "Coordinate along the axis.");
    d.required("at");
    d.number("viscosity", viscosity, unit::viscosity, not_negative, "Dynamic viscosity there.");
    d.required("viscosity");
}

void ViscosityProfile::declare(Declaration& d) {
    d.choice<int>("axis", axis, {{"x", 0}, {"y", 1}, {"z", 2}}, "Axis along which the viscosity changes.");
    d.check(axis < 2 || !d.plane_vectors(), "axis", {"must be x or y", "the scene is plane", ""});
    d.choice("interpolation", interpolation,
        {{"linear", Interpolation::linear}, {"logarithmic", Interpolation::logarithmic}},
        "Between two points the viscosity, or its logarithm, is linear.");
    d.list("points", points,
        "Viscosities in the order of their coordinates; beyond the first and the last it is theirs. "
        "Particles keep the "
        "viscosity that they start with.");
    const auto later = [](const ViscosityPoint& a, const ViscosityPoint& b) { return !(a.at < b.at); };
    d.check(std::ranges::adjacent_find(points, later) == points.end(), "points",
        {"must have increasing coordinates", "between two points the viscosity is interpolated", "sort them"});
    const bool zero = std::ranges::any_of(points, [](const ViscosityPoint& p) { return p.viscosity == 0; });
    d.check(!zero || interpolation == Interpolation::linear, "points",
        {"must have viscosities > 0", "a logarithm of 0 there is none", "write interpolation: linear"});
}

double ViscosityProfile::at(double x) const {
    const auto above = std::ranges::upper_bound(points, x, {}, &ViscosityPoint::at);
    if (above == points.begin()) return points.front().viscosity;
    if (above == points.end()) return points.back().viscosity;
    const auto& a = *(above - 1);
    const auto& b = *above;
    const double t = (x - a.at) / (b.at - a.at);
    if (interpolation == Interpolation::logarithmic) return a.viscosity * std::pow(b.viscosity / a.viscosity, t);
    return a.viscosity + t * (b.viscosity - a.viscosity);
}

} // namespace treacle::scene
