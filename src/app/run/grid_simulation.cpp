#include "app/run/grid_simulation.hpp"

#include "app/input/table_text.hpp"
#include "app/setup/bodies.hpp"
#include "app/setup/body_checks.hpp"
#include "app/setup/build_scene.hpp"
#include "app/setup/inflow.hpp"
#include "grid/geometry/seeding.hpp"
#include "grid/transport/inflow.hpp"

#include <cmath>

namespace treacle::app {

namespace {
grid::GridSetup make_setup(const Input& input, const Geometry& geometry) {
    const auto& scene = input.scene;
    grid::GridSetup out;
    out.options = input.method.grid;
    out.options.cfl = scene.time.cfl;
    out.domain = scene.domain;
    out.density = scene.liquids.front().density;
    out.liquids = static_cast<int>(scene.liquids.size());
    for (const auto& liquid : scene.liquids) {
        out.surface_tension.push_back(liquid.surface_tension);
        out.viscosity = std::max(out.viscosity, largest_viscosity(liquid));
        out.viscosity_varies =
            out.viscosity_varies || liquid.varies() || liquid.viscosity != scene.liquids.front().viscosity;
    }
    out.rheology = viscosity_models(input);
    out.rigid = make_bodies(input, geometry);
    for (const auto& body : scene.bodies) {
        out.slip.slip.push_back(body.slip);
        out.slip.slip_length.push_back(body.slip_length);
    }
    out.inflow = make_inflow(input);
    for (auto& plug : grid::make_inlet_bodies(out.inflow, grid::make_mac_grid(scene.domain))) {
        out.rigid.bodies.push_back(std::move(plug));
        out.slip.slip.push_back(scene::Slip::no_slip);
        out.slip.slip_length.push_back(0);
    }
    return out;
}

// Volume that a particle stands for [m3], in 2D [m2].
double volume_of_particle(const grid::MacGrid& grid) {
    return grid.dimensions == 2 ? grid::particle_volume(grid) / grid.dx : grid::particle_volume(grid);
}
} // namespace

GridSimulation::GridSimulation(const Comm& comm, const Input& input, const Geometry& geometry)
    : input_(input), solver_(comm, make_setup(input, geometry)), geometry_(geometry) {}

const ParticleStore& GridSimulation::solid_points() {
    if (!points_) points_.emplace(comm(), geometry_);
    points_->move_points(solver_.bodies());
    return points_->store();
}

namespace {

std::vector<std::string> notes_on_filling(const Input& input, const Geometry& geometry) {
    auto notes = geometry.notes;
    for (auto& note : body_warnings(input, geometry)) notes.push_back(std::move(note));
    for (auto& note : inflow_notes(input)) notes.push_back(std::move(note));
    return notes;
}

} // namespace

std::vector<std::string> GridSimulation::fill(const Geometry& geometry) {
    comm().guard([&] {
        grid::Seeding seeding;
        seeding.liquids = geometry.liquids;
        const grid::Solids solids(solver_.grid(), input_.scene.domain);
        seeding.solid_distance = [&](const Vec3& x) { return solids.distance_at(x, solver_.bodies()); };
        seeding.viscosity = [&](int liquid, const Vec3& x) {
            return initial_viscosity(input_, geometry, static_cast<std::size_t>(liquid), x);
        };
        for (std::size_t l = 0; l < input_.scene.liquids.size(); ++l) {
            const auto& liquid = input_.scene.liquids[l];
            seeding.velocities.push_back(
                {liquid.initial_velocity({0, 0, 0}, geometry.pivots[l]), liquid.initial_gradient()});
        }
        grid::seed(seeding, solver_.grid(), solver_.decomposition(), solver_.particles());
    });
    solver_.start();
    return notes_on_filling(input_, geometry);
}

void GridSimulation::restore(const RestartState& state) {
    solver_.restore_bodies(state.bodies);
    solver_.restore_history(state.history);
    if (state.decomposition.empty()) {
        solver_.start();
    } else {
        solver_.restore(state.decomposition);
    }
}

RestartState GridSimulation::state() const {
    return {solver_.decomposition_state(), solver_.bodies().state(), solver_.history()};
}

// A solve that ends above its residual lets the step go on (method.grid.stokes.max_iterations). The log has one line for each
// time that it doubles.
void GridSimulation::look_at_solve(const grid::StokesReport& stokes, StepDiagnostics& out) {
    if (stokes.unknowns == 0 || stokes.solve.converged() || stokes.solve.relative_residual < 2 * warned_) return;
    warned_ = stokes.solve.relative_residual;
    out.warnings.push_back("pressure and viscosity together have been solved to a residual of " +
                           short_number(warned_) + " alone in " + std::to_string(stokes.solve.iterations) +
                           " iterations; take a smaller time step, or method.grid.stokes.solve: split");
}

StepDiagnostics GridSimulation::advance(double dt) {
    auto report = solver_.advance(dt);
    StepDiagnostics out;
    out.dt = report.dt;
    out.pressure_iterations = report.pressure.solve.iterations;
    const auto& pressure = report.pressure;
    const auto& viscosity = report.viscosity;
    out.values = {double(pressure.solve.iterations), pressure.solve.relative_residual, double(pressure.unknowns),
        double(pressure.closed), double(viscosity.solve.iterations), viscosity.solve.relative_residual,
        double(viscosity.unknowns), double(report.stokes.solve.iterations), report.stokes.solve.relative_residual,
        double(report.correction.iterations), report.correction.density_before, report.correction.density_after,
        report.correction.energy, double(report.projected_out), report.imbalance};
    out.loads = of_all(report.resting_loads, report.loads);
    out.viscous_loads = of_all(report.resting_viscous_loads, report.viscous_loads);
    look_at_solve(report.stokes, out);
    out.lost = std::move(report.lost);
    out.lost_by_cause = report.lost_by_cause;
    return out;
}

LiquidView GridSimulation::view() const {
    const auto& particles = solver_.particles();
    const double spacing = particle_spacing(input_);
    return {particles.position(), particles.end_velocity(), particles.liquid(), particles.store.owned(), spacing,
        2.5 * spacing, volume_of_particle(solver_.grid()), {}};
}

// Those of what rests, and of the bodies that move. Those of the scene stand before the plugs of inlets.
std::vector<double> GridSimulation::of_all(
    const std::vector<double>& resting, const std::vector<double>& moving) const {
    std::vector<double> out(6 * load_names().size(), 0.0);
    for (std::size_t k = 0; k < out.size(); ++k) {
        const std::size_t solid = k / 6;
        const bool rests = solid < domain_sides || !moves(input_.scene.bodies[solid - domain_sides]);
        const auto& from = rests ? resting : moving;
        const std::size_t at = rests ? k : k - 6 * domain_sides;
        if (at < from.size()) out[k] = from[at];
    }
    return out;
}

std::vector<std::string> GridSimulation::load_names() const { return app::load_names(input_); }

std::vector<std::string> GridSimulation::columns() const {
    return {"pressure iterations", "pressure residual", "pressure unknowns", "closed parts", "viscosity iterations",
        "viscosity residual", "viscosity unknowns", "stokes iterations", "stokes residual", "correction iterations",
        "density error before", "density error after", "correction energy", "pushed out of solids", "imbalance"};
}

std::vector<std::string> GridSimulation::phases() const {
    return {"sort", "transfer", "surface", "pressure", "viscosity", "move", "correct"};
}

} // namespace treacle::app
