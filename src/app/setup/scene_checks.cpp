#include "app/input/table_text.hpp"
#include "app/setup/build_scene.hpp"
#include "base/options/options.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "grid/mac/mac_grid.hpp"
#include "scene/materials.hpp"

#include <algorithm>

namespace treacle::app {

namespace {
// Densities of liquids in one scene over each other, up to which they were validated (src/sph/measurements.md).
constexpr double sure_density_ratio = 10;

constexpr double largest_grid_cfl = 3;

constexpr const char* side_names[domain_sides] = {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};

// True when the surface tension is that of the liquid's material, rather than one that the user gave.
bool is_of_preset(const scene::Liquid& liquid) {
    const auto* preset = scene::find_material(liquid.material);
    return preset && preset->surface_tension == liquid.surface_tension;
}
} // namespace

std::vector<std::string> load_names(const Input& input) {
    std::vector<std::string> names(side_names, side_names + domain_sides);
    for (const auto& body : input.scene.bodies) names.push_back(body.name);
    return names;
}

namespace {
// Comparators take one liquid only.
void check_comparators(const Input& input, std::vector<Diagnostic>& problems) {
    const auto& pressure = input.method.pressure;
    const auto& where = input.scene.liquids[1].where;
    const std::string what = "liquids that differ in density or viscosity cannot go with method.pressure.";
    const auto refuse = [&](const std::string& key, const std::string& cure) {
        problems.push_back({where, what + key, "it is there to compare with and knows one liquid", cure});
    };
    if (pressure.solver == sph::PressureSolver::dfsph) refuse("solver: dfsph", "write another solver");
    if (pressure.solid_term == sph::SolidTerm::unknowns) refuse("solid_term: unknowns", "take another solid_term");
    if (pressure.dirichlet == sph::DirichletRule::ghosts) refuse("dirichlet: ghosts", "take another rule");
    if (pressure.corrections > 0) {
        problems.push_back({where, what + "corrections", "they ask for the forces of one liquid", "leave them out"});
    }
}

// One surface tension for the whole surface, which the colour of all liquids together makes.
void check_surface_tension(const Input& input, std::vector<Diagnostic>& problems) {
    const bool modelled = input.method.surface_tension.model != sph::SurfaceTensionModel::none;
    const auto& first = input.scene.liquids.front();
    for (const auto& liquid : input.scene.liquids) {
        const std::string key = "liquids." + liquid.name + ".surface_tension";
        if (!modelled && liquid.surface_tension > 0 && !is_of_preset(liquid)) {
            problems.push_back({liquid.where, key + " is not modelled with method.surface_tension.model: none",
                "it would be ignored", "write method.surface_tension.model: curvature, or leave it out"});
        } else if (modelled && liquid.surface_tension == 0) {
            problems.push_back({liquid.where, key + " = 0: must be > 0 with a method.surface_tension.model",
                "the model needs the surface tension against air", "give it, or leave out the model"});
        } else if (modelled && liquid.surface_tension != first.surface_tension) {
            problems.push_back({liquid.where, key + " differs from that of liquids." + first.name,
                "the models know one surface tension, against air, and none between liquids",
                "give the liquids the same one"});
        }
    }
}

// InputError for options that only the implicit viscosity, or some of its forms, supports.
void check_viscosity(const Input& input, std::vector<Diagnostic>& problems) {
    const auto& options = input.method.viscosity;
    const bool implicit = viscosity_integration(input) == sph::ViscosityIntegration::implicit;
    for (const auto& liquid : input.scene.liquids) {
        const std::string name = "liquids." + liquid.name;
        if (liquid.varies() && !implicit) {
            problems.push_back({liquid.where, name + ": a viscosity that varies needs the implicit viscosity",
                "the explicit one knows one viscosity per liquid", "leave out method.viscosity.integration"});
        }
        const bool by_rate = liquid.rheology.law != scene::ViscosityModelKind::newtonian;
        if (by_rate && options.form != sph::ViscosityForm::corrected && options.form != sph::ViscosityForm::adjoint) {
            problems.push_back({liquid.where, name + ".rheology needs method.viscosity.form: corrected or adjoint",
                "the other forms have no shear rate", "leave out method.viscosity.form"});
        }
    }
    const auto refuse_slip = [&](const std::string& where, const std::string& key) {
        if (options.assembled) {
            problems.push_back({where, key + ": a slip length cannot go with method.viscosity.assembled",
                "the matrix does not have its traction", "leave assembled out"});
        }
        if (options.form != sph::ViscosityForm::corrected) {
            problems.push_back({where, key + ": a slip length needs method.viscosity.form: corrected",
                "the other forms are there to compare with", "leave out method.viscosity.form"});
        }
        if (implicit) return;
        problems.push_back({where, key + ": a slip length needs a viscosity, and the implicit one",
            "it is the viscosity's force on the wall that slip limits",
            "give the liquid a viscosity and leave out method.viscosity.integration, or choose free_slip or no_slip"});
    };
    if (options.assembled && !input.scene.inlets.empty()) {
        problems.push_back({input.scene.inlets.front().where, "inlets cannot go with method.viscosity.assembled",
            "the matrix does not know what waits behind an opening", "leave assembled out"});
    }
    const bool coupled = implicit && options.coupling == sph::BodyCoupling::strong;
    for (const auto& body : input.scene.bodies) {
        if (body.kind != scene::BodyKind::dynamic || !coupled) continue;
        const auto refuse = [&](const std::string& key, const std::string& why) {
            problems.push_back({body.where, "bodies." + body.name + " is dynamic, with method.viscosity." + key, why,
                "leave " + key + " out, or write method.viscosity.coupling: weak"});
        };
        if (options.assembled) refuse("assembled", "the matrix has no bodies as unknowns");
        if (options.guess == sph::ViscosityGuess::last_change)
            refuse("guess", "it knows the liquid's velocities alone");
    }
    for (const auto& body : input.scene.bodies) {
        if (body.slip == scene::Slip::slip_length) refuse_slip(body.where, "bodies." + body.name + ".slip");
    }
    for (std::size_t k = 0; k < domain_sides; ++k) {
        const auto& face = input.scene.domain.faces[k];
        if (face.slip == scene::Slip::slip_length) {
            refuse_slip(face.where, std::string("domain.boundaries.") + side_names[k] + ".slip");
        }
    }
}
} // namespace

namespace {
// Options of the method that was not chosen would be ignored.
void check_method(const Input& input, std::vector<Diagnostic>& problems) {
    const auto& where = input.method.where;
    const bool sph_given = effective(static_cast<const sph::SphOptions&>(input.method)) != effective(sph::SphOptions{});
    if (input.on_grid() && sph_given) {
        problems.push_back({where, "method.kind is grid, and options of sph are given", "they would be ignored",
            "leave them out; those of the grid stand in method.grid"});
    }
    if (!input.on_grid() && effective(input.method.grid) != effective(grid::GridOptions{})) {
        problems.push_back({where, "method.grid is given, and method.kind is sph", "its options would be ignored",
            "write method.kind: grid, or leave method.grid out"});
    }
}

// InputError for options that the grid's solver does not support.
void check_grid(const Input& input, std::vector<Diagnostic>& problems) {
    const auto refuse = [&](const std::string& where, const std::string& what, const std::string& cure) {
        problems.push_back({where, what + " cannot go with method.kind: grid", "it would be ignored", cure});
    };
    for (const auto& liquid : input.scene.liquids) {
        if (liquid.density != input.scene.liquids.front().density) {
            refuse(liquid.where, "liquids." + liquid.name + ": another density than that of the first liquid",
                "give all the same, or take method.kind: sph");
        }
    }
    if (input.scene.time.cfl > largest_grid_cfl) {
        problems.push_back({input.scene.time.where, "time.cfl is above 3",
            "the arrays of method grid reach three cells beyond a rank's own", "take 3 or less"});
    }
    for (std::size_t k = 0; k < domain_sides; ++k) {
        const auto& face = input.scene.domain.faces[k];
        if (face.skin_friction > 0) {
            refuse(face.where, std::string("domain.boundaries.") + side_names[k] + ".skin_friction", "choose a slip");
        }
    }
    for (const auto& body : input.scene.bodies) {
        if (body.skin_friction > 0) refuse(body.where, "bodies." + body.name + ".skin_friction", "choose a slip");
    }
}
} // namespace

void check_supported(const Input& input) {
    std::vector<Diagnostic> problems;
    check_method(input, problems);
    if (input.on_grid()) {
        check_grid(input, problems);
        if (!problems.empty()) throw InputError(std::move(problems));
        grid::make_mac_grid(input.scene.domain);
        return;
    }
    if (input.scene.time.cfl > 1) {
        problems.push_back({input.scene.time.where, "time.cfl is above 1",
            "particles of method sph would jump over their neighbours", "0.2 is usual"});
    }
    if (sph::differ(liquid_materials(input))) check_comparators(input, problems);
    check_surface_tension(input, problems);
    check_viscosity(input, problems);
    if (!problems.empty()) throw InputError(std::move(problems));
    sph::make_cell_grid(input.scene.domain, input.method.support_ratio * input.scene.domain.spacing);
}

std::vector<std::string> method_notes(const Input& input) {
    std::vector<std::string> notes;
    if (input.on_grid()) return notes;
    const auto [light, heavy] = std::ranges::minmax(input.scene.liquids, {}, &scene::Liquid::density);
    const double ratio = heavy.density / light.density;
    if (ratio > sure_density_ratio) {
        const auto [given, bound] = tell_apart(ratio, sure_density_ratio);
        notes.push_back("liquids: " + heavy.name + " has " + given + " times the density of " + light.name +
                        "; what was measured ends at " + bound + " times, beyond that take smaller steps and compare");
    }
    const bool modelled = input.method.surface_tension.model != sph::SurfaceTensionModel::none;
    for (const auto& liquid : input.scene.liquids) {
        if (liquid.surface_tension == 0 || modelled) continue;
        notes.push_back("liquids." + liquid.name +
                        ": method.surface_tension.model is none, which does not model the surface "
                        "tension of " +
                        liquid.material);
    }
    return notes;
}

} // namespace treacle::app
