#include "app/run/sph_simulation.hpp"

#include "app/setup/build_scene.hpp"

namespace treacle::app {

SphSimulation::SphSimulation(const Comm& comm, const Input& input, double reference_speed, const Geometry& geometry)
    : input_(input), solver_(make_solver(comm, input, reference_speed, geometry)) {}

std::vector<std::string> SphSimulation::fill(const Geometry& geometry) {
    return fill_solver(input_, geometry, *solver_);
}

void SphSimulation::restore(const RestartState& state) {
    solver_->restore_bodies(state.bodies);
    solver_->restore_history(state.history);
    if (state.decomposition.empty()) {
        solver_->start(sph::IsphStep::SolidVolumes::keep);
    } else {
        solver_->restore(state.decomposition);
    }
}

RestartState SphSimulation::state() const {
    return {solver_->decomposition_state(), solver_->bodies().state(), solver_->history()};
}

StepDiagnostics SphSimulation::advance(double dt) {
    auto report = solver_->advance(dt);
    StepDiagnostics out;
    out.dt = report.dt;
    out.pressure_iterations = report.pressure.iterations;
    out.values = {double(report.pressure.iterations), report.pressure.relative_residual, report.pressure.error_measure,
        double(report.viscosity.iterations), report.viscosity.relative_residual, report.mean_compression,
        report.max_compression, double(report.roles.poisson), double(report.roles.dirichlet),
        double(report.roles.separated), double(report.pinned), double(report.stopped), report.imbalance};
    out.loads = std::move(report.loads);
    out.viscous_loads = std::move(report.viscous_loads);
    out.lost = std::move(report.lost);
    out.lost_by_cause = report.lost_by_cause;
    return out;
}

std::vector<std::string> SphSimulation::load_names() const { return app::load_names(input_); }

std::vector<std::string> SphSimulation::columns() const {
    return {"pressure iterations", "pressure residual", "density error", "viscosity iterations", "viscosity residual",
        "mean compression", "max compression", "poisson", "dirichlet", "separated", "anchored", "stopped at solids",
        "imbalance"};
}

std::vector<std::string> SphSimulation::phases() const {
    return {"sort", "neighbours", "density", "forces", "viscosity", "predict", "assemble", "solve", "pressure force",
        "move"};
}

LiquidTotals SphSimulation::totals() const { return solver_->totals(); }

LiquidView SphSimulation::view() const {
    const auto& liquid = solver_->liquid();
    const auto& constants = solver_->setup().constants;
    return {liquid.position(), liquid.end_velocity(), liquid.liquid(), liquid.store.owned(), constants.spacing,
        constants.support, constants.rest_volume, liquid.has_inlets() ? liquid.inlet() : Array<int>()};
}

} // namespace treacle::app
