#include "app/setup/build_scene.hpp"

#include "app/input/table_text.hpp"
#include "app/setup/bodies.hpp"
#include "app/setup/inflow.hpp"
#include "base/options/options.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "grid/mac/mac_grid.hpp"
#include "scene/materials.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {
// Densities of liquids in one scene over each other, up to which they were tried (src/sph/README.md).
constexpr double sure_density_ratio = 10;

// Spacings over the reference speed in which compressed particles of several liquids expand again.
constexpr double recovery_cfl = 0.1;

constexpr double largest_grid_cfl = 3;

constexpr const char* side_names[domain_sides] = {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};

double friction_of(scene::Slip slip) { return slip == scene::Slip::no_slip ? 1.0 : 0.0; }

// Whether the surface tension is that of the liquid's material, rather than one that the user gave.
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
// What is there to compare with knows one liquid.
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

// What only the implicit viscosity, or some of its forms, can do.
void check_viscosity(const Input& input, std::vector<Diagnostic>& problems) {
    const auto& options = input.method.viscosity;
    const bool implicit = viscosity_integration(input) == sph::ViscosityIntegration::implicit;
    for (const auto& liquid : input.scene.liquids) {
        const std::string name = "liquids." + liquid.name;
        if (liquid.varies() && !implicit) {
            problems.push_back({liquid.where, name + ": a viscosity that varies needs the implicit viscosity",
                                "the explicit one knows one viscosity per liquid", "leave out method.viscosity.integration"});
        }
        const bool by_rate = liquid.rheology.law != scene::ShearLaw::newtonian;
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
    const bool coupled = implicit && options.body_coupling == sph::BodyCoupling::implicit;
    for (const auto& body : input.scene.bodies) {
        if (body.kind != scene::BodyKind::dynamic || !coupled) continue;
        const auto refuse = [&](const std::string& key, const std::string& why) {
            problems.push_back({body.where, "bodies." + body.name + " is dynamic, with method.viscosity." + key, why,
                                "leave " + key + " out, or write method.viscosity.body_coupling: explicit"});
        };
        if (options.assembled) refuse("assembled", "the matrix has no bodies as unknowns");
        if (options.guess == sph::ViscosityGuess::last_change) refuse("guess", "it knows the liquid's velocities alone");
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

// What the grid's solver does not do yet.
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
        problems.push_back({input.scene.time.where, "time.cfl is above 3", "the arrays of method grid reach three cells beyond a rank's own",
                            "take 3 or less"});
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
        problems.push_back({input.scene.time.where, "time.cfl is above 1", "particles of method sph would jump over their neighbours",
                            "0.2 is usual"});
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
                        "; what was measured ends at " + bound +
                        " times, beyond that take smaller steps and compare");
    }
    const bool modelled = input.method.surface_tension.model != sph::SurfaceTensionModel::none;
    for (const auto& liquid : input.scene.liquids) {
        if (liquid.surface_tension == 0 || modelled) continue;
        notes.push_back("liquids." + liquid.name + ": method.surface_tension.model is none, which does not model the surface "
                        "tension of " + liquid.material);
    }
    return notes;
}

double reference_speed(const Input& input, const Geometry& geometry) {
    if (input.method.viscosity.reference_speed > 0) return input.method.viscosity.reference_speed;
    const auto& g = input.scene.domain.gravity;
    const double pull = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    if (pull == 0) return 0;
    double lowest = 1e300, highest = -1e300;
    for (const auto& regions : geometry.liquids) {
        for (const auto& region : regions) {
            const auto bounds = region.bounds();
            for (int corner = 0; corner < 8; ++corner) {
                double along = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    const double x = corner >> k & 1 ? std::min(bounds.max[k], input.scene.domain.max[k])
                                                     : std::max(bounds.min[k], input.scene.domain.min[k]);
                    if (g[k] != 0) along += x * g[k] / pull;
                }
                lowest = std::min(lowest, along);
                highest = std::max(highest, along);
            }
        }
    }
    return std::sqrt(pull * std::max(0.0, highest - lowest));
}

std::unique_ptr<sph::IsphStep> make_solver(const Comm& comm, const Input& input, double reference_speed,
                                           const Geometry& geometry) {
    sph::IsphSetup setup;
    setup.options = input.method;
    setup.options.viscosity.integration = viscosity_integration(input);
    setup.constants = make_constants(input);
    setup.constants.wall_depth = solid_offset(input);
    const auto& domain = input.scene.domain;
    setup.domain = sph::make_domain_box(domain, solid_offset(input) + 0.5 * domain.spacing);
    setup.grid = sph::make_cell_grid(domain, setup.constants.support);
    setup.forces.gravity = domain.gravity;
    setup.forces.viscosity = limiting_viscosity(input);
    setup.forces.surface_tension = input.scene.liquids.front().surface_tension;
    const auto materials = liquid_materials(input);
    if (sph::differ(materials)) {
        setup.constants.mixture = sph::make_mixture(materials, input.method.pressure.solver == sph::PressureSolver::isph ? sph::Loads::conducted : sph::Loads::adjoint);
        if (reference_speed > 0) setup.constants.mixture.recovery = recovery_cfl * domain.spacing / reference_speed;
    }
    for (const auto& face : domain.faces) setup.forces.friction.push_back(friction_of(face.slip));
    for (const auto& body : input.scene.bodies) setup.forces.friction.push_back(friction_of(body.slip));
    for (const auto& face : domain.faces) setup.forces.slip_length.push_back(face.slip_length);
    for (const auto& body : input.scene.bodies) setup.forces.slip_length.push_back(body.slip_length);
    setup.forces.by_particle = viscosities_vary(input);
    setup.forces.rheology = flow_curves(input);
    for (const auto& face : domain.faces) setup.forces.skin_friction.push_back(face.skin_friction);
    for (const auto& body : input.scene.bodies) setup.forces.skin_friction.push_back(body.skin_friction);
    setup.reference_speed = reference_speed;
    setup.bodies = domain_sides + static_cast<int>(input.scene.bodies.size());
    if (any_moves(input)) {
        setup.rigid = make_bodies(input, geometry);
        setup.solid_scale = solid_scales(input, geometry);
    }
    setup.first_body = domain_sides;
    if (domain.any_side_moves()) {
        for (const auto& face : domain.faces) setup.sides.push_back(face.velocity);
        setup.constants.conveyors = domain_sides;
    }
    setup.inflow = make_inflow(input);
    setup.forces.artificial = input.method.viscosity.artificial * setup.constants.support * reference_speed;
    return std::make_unique<sph::IsphStep>(comm, setup);
}

namespace {
// The cells of a rank as a box of space; the outermost ones reach to infinity.
scene::Bounds part_of(const CellGrid& grid, const CellBox& box) {
    scene::Bounds part;
    for (int k = 0; k < 3; ++k) {
        const auto u = static_cast<std::size_t>(k);
        if (box.lo[k] > 0) part.min[u] = grid.origin[k] + box.lo[k] / grid.inverse_width[k];
        if (box.hi[k] < grid.count[k]) part.max[u] = grid.origin[k] + box.hi[k] / grid.inverse_width[k];
    }
    return part;
}

bool inside(const scene::Bounds& part, const Vec3& x) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (x[k] < part.min[k] || x[k] >= part.max[k]) return false;
    }
    return true;
}

// Host copies of the fields of a store, to be filled row by row.
template <class View>
class Column {
public:
    explicit Column(const View& view) : view_(view), host_(Kokkos::create_mirror_view(view)) {}
    ~Column() { Kokkos::deep_copy(view_, host_); }
    auto& operator*() { return host_; }

private:
    View view_;
    typename View::HostMirror host_;
};

// Collective: the liquid's points of this rank, none with an empty box.
scene::VolumeSamples sample_liquid(const Input& input, const Geometry& geometry, const sph::IsphStep& solver) {
    constexpr double tolerance = 0.002; // of the volume
    const auto& comm = solver.comm();
    const auto& box = solver.decomposition().box();
    auto fill = liquid_fill(input, geometry, geometry.lattice);
    fill.part = part_of(solver.setup().grid, box);
    scene::VolumeSamples samples;
    const auto fill_part = [&] {
        if (!box.empty()) samples = scene::fill_volume(fill);
    };
    comm.guard(fill_part);
    if (fill.clearance > 0 || geometry.bodies.empty()) return samples;
    const double taken = comm.sum(double(samples.positions.size())), room = comm.sum(samples.room);
    if (std::abs(taken - room) <= tolerance * room) return samples;
    fill.filling = scene::Filling::room;
    comm.guard(fill_part);
    return samples;
}

void add_liquid(const Input& input, const Geometry& geometry, const scene::VolumeSamples& samples, sph::IsphStep& solver) {
    auto& liquid = solver.liquid();
    liquid.store.resize_owned(static_cast<int>(samples.positions.size()));
    Column x(liquid.position()), u(liquid.velocity());
    Column id(liquid.id());
    Column which(liquid.liquid());
    Column p(liquid.pressure()), viscosity(liquid.viscosity());
    for (std::size_t i = 0; i < samples.positions.size(); ++i) {
        const auto l = static_cast<std::size_t>(samples.liquids[i]);
        const Vec3 velocity = input.scene.liquids[l].initial_velocity(samples.positions[i], geometry.pivots[l]);
        for (int k = 0; k < 3; ++k) {
            const auto c = static_cast<std::size_t>(k);
            (*x)(i, k) = solver.setup().domain.wrap(k, samples.positions[i][c]);
            (*u)(i, k) = velocity[c];
        }
        (*id)(i) = static_cast<std::int64_t>(samples.ids[i]);
        (*which)(i) = samples.liquids[i];
        (*p)(i) = 0;
        (*viscosity)(i) = initial_viscosity(input, geometry, static_cast<std::size_t>(samples.liquids[i]), samples.positions[i]);
    }
}

struct SolidSample {
    Vec3 position;
    Vec3 normal;
    std::int64_t id;
    int body;
};

struct SolidSamples {
    std::vector<SolidSample> rows;
    std::size_t thin = 0; // of the whole domain
};

SolidSamples sample_solids(const Geometry& geometry, const scene::Bounds& part) {
    SolidSamples out;
    auto walls = geometry.walls;
    walls.part = part;
    const auto samples = scene::sample_domain_walls(walls);
    for (std::size_t i = 0; i < samples.positions.size(); ++i) {
        out.rows.push_back({samples.positions[i], samples.normals[i], static_cast<std::int64_t>(samples.ids[i]), samples.faces[i]});
    }
    auto next = static_cast<std::int64_t>(scene::count_domain_walls(geometry.walls));
    for (std::size_t b = 0; b < geometry.bodies.size(); ++b) {
        const auto surface = scene::sample_surface(geometry.bodies[b], body_sampling(geometry, b));
        out.thin += surface.thin;
        for (std::size_t i = 0; i < surface.positions.size(); ++i) {
            const std::int64_t id = next++;
            if (!inside(part, surface.positions[i])) continue;
            out.rows.push_back({surface.positions[i], surface.normals[i], id, domain_sides + static_cast<int>(b)});
        }
    }
    return out;
}

std::size_t add_solids(const Geometry& geometry, const scene::Bounds& part, sph::IsphStep& solver) {
    const auto sampled = sample_solids(geometry, part);
    const auto& samples = sampled.rows;
    auto& solid = solver.solid();
    solid.store.resize_owned(static_cast<int>(samples.size()));
    Column x(solid.position()), v(solid.velocity()), normal(solid.normal());
    Column id(solid.id());
    Column body(solid.body());
    Column volume(solid.volume()), pressure(solid.pressure());
    const auto& sides = solver.setup().sides;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const auto side = static_cast<std::size_t>(samples[i].body);
        for (int k = 0; k < 3; ++k) {
            (*x)(i, k) = solver.setup().domain.wrap(k, samples[i].position[static_cast<std::size_t>(k)]);
            (*v)(i, k) = side < sides.size() ? sides[side][static_cast<std::size_t>(k)] : 0.0;
            (*normal)(i, k) = samples[i].normal[static_cast<std::size_t>(k)];
        }
        (*id)(i) = samples[i].id;
        (*body)(i) = samples[i].body;
        (*volume)(i) = 0;
        (*pressure)(i) = 0;
    }
    return sampled.thin;
}

// Most times that liquid beside bodies is spread: it settles to a per mille in ten.
constexpr int spreads = 30;
} // namespace

std::vector<std::string> fill_solver(const Input& input, const Geometry& geometry, sph::IsphStep& solver) {
    const auto part = part_of(solver.setup().grid, solver.decomposition().box());
    const bool empty = solver.decomposition().box().empty();
    std::int64_t thin = 0;
    const auto samples = sample_liquid(input, geometry, solver);
    solver.comm().guard([&] {
        if (empty) return;
        add_liquid(input, geometry, samples, solver);
        thin = static_cast<std::int64_t>(add_solids(geometry, part, solver));
    });
    solver.start();
    if (input.method.pressure.recovers_places() && !geometry.bodies.empty()) solver.spread(spreads);
    auto notes = geometry.notes;
    for (auto& note : body_notes(input, geometry)) notes.push_back(std::move(note));
    for (auto& note : method_notes(input)) notes.push_back(std::move(note));
    for (auto& note : inflow_notes(input)) notes.push_back(std::move(note));
    thin = solver.comm().max(thin);
    if (thin > 0) notes.push_back(thin_note(static_cast<std::size_t>(thin)));
    return notes;
}

} // namespace treacle::app
