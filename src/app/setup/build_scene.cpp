#include "app/setup/build_scene.hpp"

#include "app/input/table_text.hpp"
#include "app/setup/bodies.hpp"
#include "app/setup/body_checks.hpp"
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
// Spacings over the reference speed in which compressed particles of several liquids expand again.
constexpr double recovery_cfl = 0.1;

double friction_of(scene::Slip slip) { return slip == scene::Slip::no_slip ? 1.0 : 0.0; }

} // namespace

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

std::unique_ptr<sph::IsphStep> make_solver(
    const Comm& comm, const Input& input, double reference_speed, const Geometry& geometry) {
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
        setup.constants.immiscible = sph::make_immiscible_liquids(materials,
            input.method.pressure.solver == sph::PressureSolver::isph ? sph::Loads::conducted : sph::Loads::adjoint);
        if (reference_speed > 0)
            setup.constants.immiscible.relaxation_time = recovery_cfl * domain.spacing / reference_speed;
    }
    for (const auto& face : domain.faces) setup.forces.friction.push_back(friction_of(face.slip));
    for (const auto& body : input.scene.bodies) setup.forces.friction.push_back(friction_of(body.slip));
    for (const auto& face : domain.faces) setup.forces.slip_length.push_back(face.slip_length);
    for (const auto& body : input.scene.bodies) setup.forces.slip_length.push_back(body.slip_length);
    setup.forces.by_particle = viscosities_vary(input);
    setup.forces.rheology = viscosity_models(input);
    for (const auto& face : domain.faces) setup.forces.skin_friction.push_back(face.skin_friction);
    for (const auto& body : input.scene.bodies) setup.forces.skin_friction.push_back(body.skin_friction);
    setup.reference_speed = reference_speed;
    setup.bodies = domain_sides + static_cast<int>(input.scene.bodies.size());
    if (any_moves(input)) {
        setup.rigid = make_bodies(input, geometry);
        setup.boundary_volume_factor = boundary_volume_factors(input, geometry);
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

void add_liquid(
    const Input& input, const Geometry& geometry, const scene::VolumeSamples& samples, sph::IsphStep& solver) {
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
        (*viscosity)(i) =
            initial_viscosity(input, geometry, static_cast<std::size_t>(samples.liquids[i]), samples.positions[i]);
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

namespace {

void add_walls(const Geometry& geometry, const scene::Bounds& part, SolidSamples& out) {
    auto walls = geometry.walls;
    walls.part = part;
    const auto samples = scene::sample_domain_walls(walls);
    for (std::size_t i = 0; i < samples.positions.size(); ++i) {
        out.rows.push_back(
            {samples.positions[i], samples.normals[i], static_cast<std::int64_t>(samples.ids[i]), samples.faces[i]});
    }
}

} // namespace

SolidSamples sample_solids(const Geometry& geometry, const scene::Bounds& part) {
    SolidSamples out;
    add_walls(geometry, part, out);
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
    if (input.method.pressure.recovers_positions() && !geometry.bodies.empty()) solver.spread(spreads);
    auto notes = geometry.notes;
    for (auto& note : body_warnings(input, geometry)) notes.push_back(std::move(note));
    for (auto& note : method_notes(input)) notes.push_back(std::move(note));
    for (auto& note : inflow_notes(input)) notes.push_back(std::move(note));
    thin = solver.comm().max(thin);
    if (thin > 0) notes.push_back(thin_note(static_cast<std::size_t>(thin)));
    return notes;
}

} // namespace treacle::app
