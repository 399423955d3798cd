#include "app/setup/geometry.hpp"
#include "sph/forces/forces.hpp"

#include <algorithm>

namespace treacle::app {

double largest_viscosity(const scene::Liquid& liquid) {
    if (liquid.rheology.law != scene::ViscosityModelKind::newtonian) {
        const auto curve = flow::make_viscosity_model(liquid);
        constexpr double fast = 1e6; // [1/s] beyond what any scene has, for liquids that thicken
        return std::max(curve(0), curve(fast));
    }
    const auto& points = liquid.viscosity_profile.points;
    double most = points.empty() ? liquid.viscosity : 0;
    for (const auto& point : points) most = std::max(most, point.viscosity);
    for (const auto& region : liquid.viscosity_regions) most = std::max(most, region.viscosity);
    return most;
}

double inflow_viscosity(const scene::Liquid& liquid, const Vec3& x) {
    if (liquid.rheology.law != scene::ViscosityModelKind::newtonian) return flow::make_viscosity_model(liquid)(0);
    const auto& profile = liquid.viscosity_profile;
    return profile.points.empty() ? liquid.viscosity : profile.at(x[static_cast<std::size_t>(profile.axis)]);
}

double initial_viscosity(const Input& input, const Geometry& geometry, std::size_t which, const Vec3& x) {
    const auto& liquid = input.scene.liquids[which];
    double viscosity = inflow_viscosity(liquid, x);
    for (std::size_t k = 0; k < liquid.viscosity_regions.size(); ++k) {
        if (geometry.viscosity_regions[which][k].distance(x) <= 0) viscosity = liquid.viscosity_regions[k].viscosity;
    }
    return viscosity;
}

std::vector<flow::ViscosityModel> viscosity_models(const Input& input) {
    const auto thins = [](const scene::Liquid& liquid) {
        return liquid.rheology.law != scene::ViscosityModelKind::newtonian;
    };
    std::vector<flow::ViscosityModel> out;
    if (std::ranges::none_of(input.scene.liquids, thins)) return out;
    for (const auto& liquid : input.scene.liquids) out.push_back(flow::make_viscosity_model(liquid));
    return out;
}

bool viscosities_vary(const Input& input) { return std::ranges::any_of(input.scene.liquids, &scene::Liquid::varies); }

std::vector<sph::LiquidMaterial> liquid_materials(const Input& input) {
    std::vector<sph::LiquidMaterial> out;
    for (const auto& liquid : input.scene.liquids) out.push_back({liquid.density, largest_viscosity(liquid)});
    return out;
}

double limiting_viscosity(const Input& input) {
    const auto materials = liquid_materials(input);
    if (!sph::differ(materials)) return materials.front().viscosity;
    return materials.front().density * sph::largest_kinematic_viscosity(materials);
}

} // namespace treacle::app
