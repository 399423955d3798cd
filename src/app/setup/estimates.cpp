#include "app/setup/estimates.hpp"

#include "app/setup/inflow.hpp"
#include "sph/forces/forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace treacle::app {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

double length_of(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }

// Carries a box on over the part of a liquid that is in the domain at the start.
void extend(scene::Bounds& box, const scene::Domain& domain, const scene::Regions& liquid) {
    for (const auto& region : liquid) {
        const auto part = region.bounds();
        for (std::size_t k = 0; k < 3; ++k) {
            box.min[k] = std::min(box.min[k], std::max(part.min[k], domain.min[k]));
            box.max[k] = std::max(box.max[k], std::min(part.max[k], domain.max[k]));
        }
    }
}

// The box that the liquids fill of the domain at the start.
scene::Bounds liquid_box(const Input& input, const Geometry& geometry) {
    auto box = scene::Bounds::nothing();
    for (const auto& liquid : geometry.liquids) extend(box, input.scene.domain, liquid);
    return box;
}

// Upper bound of a liquid's speed at the start: that of the corners of its box [m/s].
double initial_speed(const Input& input, const Geometry& geometry, std::size_t which) {
    const auto& liquid = input.scene.liquids[which];
    if (!liquid.sheared()) return length_of(liquid.velocity);
    auto box = scene::Bounds::nothing();
    extend(box, input.scene.domain, geometry.liquids[which]);
    double most = 0;
    for (int corner = 0; corner < 8; ++corner) {
        Vec3 x{0, 0, 0};
        for (std::size_t k = 0; k < static_cast<std::size_t>(input.scene.domain.dimensions); ++k) {
            x[k] = corner >> k & 1 ? box.max[k] : box.min[k];
        }
        most = std::max(most, length_of(liquid.initial_velocity(x, geometry.pivots[which])));
    }
    return most;
}

double typical_length(const Input& input, const Geometry& geometry) {
    const auto& domain = input.scene.domain;
    const auto box = liquid_box(input, geometry);
    const double pull = length_of(domain.gravity);
    double along = 0, longest = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(domain.dimensions); ++k) {
        const double edge = std::max(0.0, box.max[k] - box.min[k]);
        if (pull > 0) along += std::abs(domain.gravity[k]) / pull * edge;
        longest = std::max(longest, edge);
    }
    return pull > 0 ? along : longest;
}

} // namespace

Estimates estimate_run(const Input& input, const Geometry& geometry, std::uint64_t liquid, std::uint64_t solid) {
    const auto& scene = input.scene;
    const double pull = length_of(scene.domain.gravity);
    const double d = scene.domain.spacing;
    Estimates out;
    out.length = typical_length(input, geometry);
    for (std::size_t l = 0; l < scene.liquids.size(); ++l) {
        out.initial_speed = std::max(out.initial_speed, initial_speed(input, geometry, l));
    }
    const auto inflow = make_inflow(input);
    for (const auto& inlet : inflow.inlets) out.initial_speed = std::max(out.initial_speed, inlet.speed);
    out.speed = std::max(out.initial_speed, std::sqrt(pull * out.length));
    const double cfl = scene.time.cfl * sph::time_step_factor(liquid_materials(input));
    out.courant_step = out.speed > 0 ? cfl * d / out.speed : infinite;
    out.gravity_step = pull > 0 ? cfl * std::sqrt(d / pull) : infinite;
    const bool limited = !input.on_grid() && limiting_viscosity(input) > 0 &&
                         viscosity_integration(input) != sph::ViscosityIntegration::implicit;
    out.viscous_step = limited ? viscous_step_limit(input) : infinite;
    const bool has_surface_tension = input.method.surface_tension.model != sph::SurfaceTensionModel::none;
    out.capillary_step = has_surface_tension ? capillary_step_limit(input) : infinite;
    if (scene.time.rule == scene::StepRule::fixed) {
        out.step = scene.time.step;
    } else {
        out.step = std::min({out.courant_step, out.gravity_step, out.viscous_step, out.capillary_step,
            scene.time.step > 0 ? scene.time.step : infinite});
    }
    out.steps = std::ceil(scene.time.end / out.step);
    out.poured = static_cast<double>(inflow_particles(input));
    out.bytes =
        bytes_per_particle(input) * (static_cast<double>(liquid) + out.poured) + 200.0 * static_cast<double>(solid);
    return out;
}

namespace {
void add_numbers_of(const scene::Liquid& liquid, const std::string& which, double pull, const Estimates& estimates,
    std::vector<DimensionlessNumber>& out) {
    const double length = estimates.length, speed = estimates.speed;
    const auto add = [&](const char* name, const char* formula, double value) {
        out.push_back({name + which, formula, value});
    };
    if (liquid.viscosity > 0 && speed > 0 && length > 0) {
        add("Reynolds number", "rho U H / mu", liquid.density * speed * length / liquid.viscosity);
    }
    const double tension = liquid.surface_tension;
    if (tension <= 0) return;
    if (pull > 0) add("Bond number", "rho g H^2 / sigma", liquid.density * pull * length * length / tension);
    if (speed > 0) add("Weber number", "rho U^2 H / sigma", liquid.density * speed * speed * length / tension);
    if (liquid.viscosity > 0 && speed > 0) add("capillary number", "mu U / sigma", liquid.viscosity * speed / tension);
}
} // namespace

std::vector<DimensionlessNumber> dimensionless_numbers(const Input& input, const Estimates& estimates) {
    const auto& liquids = input.scene.liquids;
    const double pull = length_of(input.scene.domain.gravity);
    std::vector<DimensionlessNumber> out;
    if (pull > 0 && estimates.initial_speed > 0 && estimates.length > 0) {
        out.push_back(
            {"Froude number", "U0 / sqrt(g H)", estimates.initial_speed / std::sqrt(pull * estimates.length)});
    }
    if (!sph::differ(liquid_materials(input))) {
        add_numbers_of(liquids.front(), "", pull, estimates, out);
        return out;
    }
    for (const auto& liquid : liquids) add_numbers_of(liquid, " " + liquid.name, pull, estimates, out);
    const auto [light, heavy] = std::ranges::minmax(liquids, {}, &scene::Liquid::density);
    out.push_back({"Atwood number", "(rho1 - rho2) / (rho1 + rho2)",
        (heavy.density - light.density) / (heavy.density + light.density)});
    return out;
}

} // namespace treacle::app
