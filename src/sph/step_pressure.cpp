#include "sph/step_pressure.hpp"

#include "base/text/error.hpp"
#include "sph/forces/forces.hpp"
#include "sph/forces/wall_contact.hpp"

#include <algorithm>
#include <string>

namespace treacle::sph {

namespace {
bool bounded(const SphOptions& options) { return options.pressure.dirichlet == DirichletRule::complementarity; }

bool implicit_bodies(const SphOptions& options, const Bodies& bodies) {
    return bodies.any_dynamic() && options.pressure.coupling == BodyCoupling::strong;
}

// Adds the work of another solve of the same step.
void add_work(const solve::SolveReport& other, solve::SolveReport& to) {
    to.iterations += other.iterations;
    to.products += other.products;
    to.iteration_seconds += other.iteration_seconds;
}

[[noreturn]] void fail(const solve::SolveReport& report, std::int64_t unknowns, const std::string& instead) {
    throw SimulationError({"pressure solve", report.reason,
        "after " + std::to_string(report.iterations) + " iterations on " + std::to_string(unknowns) + " unknowns",
        "take a smaller time step, or " + instead});
}

std::int64_t particles(const StepContext& parts) {
    return parts.comm.sum(static_cast<std::int64_t>(parts.liquid.store.owned()));
}
} // namespace

bool solids_unknown(const SphOptions& options) {
    return options.pressure.solver == PressureSolver::isph && options.pressure.solid_term == SolidTerm::unknowns;
}

StepPressure::StepPressure(const Comm& comm, const SphOptions& options, const Constants& constants,
    const DomainBox& domain, const CellGrid& grid, const Vec3& gravity)
    : comm_(comm), options_(options), constants_(constants), iisph_(gravity),
      hierarchy_(make_hierarchy(comm, options, constants, domain, grid)),
      solver_(comm, "pressure", krylov_options(options, constants.dimensions, hierarchy_.get())),
      complementarity_(comm, solver_.options()) {}

void StepPressure::add_fields(LiquidParticles& liquid) {
    if (options_.pressure.solver != PressureSolver::dfsph) return;
    divergence_field_ = liquid.store.add<Array<double>>("divergence_pressure", "Pa", FieldRole::state);
}

void StepPressure::start(LiquidParticles& liquid, LastPressures last) {
    last_pressures_ = last;
    if (divergence_field_ < 0 || last == LastPressures::known) return;
    Kokkos::deep_copy(liquid.store.get<Array<double>>(divergence_field_), 0.0);
}

ComplementarityContext StepPressure::complementarity_parts(const StepContext& parts) {
    return {options_, constants_, comm_, parts.liquid, parts.neighbours, parts.halo, pinning_};
}

void StepPressure::find_around_solids(const PressureParts& parts) {
    const auto& liquid = parts.step.liquid.store;
    solid_rows_.liquid.build(parts.solid.store, liquid, parts.grid, parts.step.cells, constants_.support);
    solid_rows_.solid.build(parts.solid.store, parts.solid.store, parts.grid, parts.solid_cells, constants_.support);
}

// (S5), (S6)
void StepPressure::predict_roles(const PressureParts& parts, StepReport& report, double dt) {
    const auto& [options, constants, comm, liquid, solid, neighbours, halo, cells, driven] = parts.step;
    const bool answering = implicit_bodies(options, parts.bodies);
    if (answering) {
        response_.build(parts.step, parts.bodies);
        response_.apply_to_pressure(comm, liquid);
    }
    report.roles = predict(parts.step, last_pressures_, dt, answering ? BodyCoupling::strong : BodyCoupling::weak);
    last_pressures_ = LastPressures::known;
    if (parts.inflow) {
        parts.inflow->close(liquid);
        report.roles = count_roles(liquid);
    }
    halo.gather(liquid.store, {liquid.role_field()});
    if (solids_unknown(options)) {
        find_around_solids(parts);
        report.roles.poisson +=
            solid_rows_.predict(options, constants, liquid, parts.solid, neighbours, parts.solid_halo);
    }
    report.pinned = bounded(options) ? complementarity_.anchor(complementarity_parts(parts.step))
                                     : pinning_.anchor(options, constants, comm, liquid, neighbours, halo);
}

void StepPressure::assemble(const PressureParts& parts) {
    const auto& step = parts.step;
    if (solids_unknown(options_)) {
        system_.assemble_with_solids(options_, constants_, comm_,
            {step.liquid, parts.solid, step.neighbours, solid_rows_, step.halo, parts.solid_halo});
    } else {
        system_.assemble(options_, constants_, comm_, step.liquid, step.neighbours, step.halo);
    }
}

solve::ConvergenceTest StepPressure::convergence_test(const StepReport& report, double dt) const {
    const auto& pressure = options_.pressure;
    if (pressure.stop != StoppingRule::density_error) return solve::ConvergenceTest::residual(pressure.residual);
    // Mean compression that the residual leaves: r dt^2 is what the predicted density still exceeds rho0 by.
    const double unknowns = bounded(options_) ? double(comm_.sum(report.roles.poisson)) : double(system_.global_rows());
    const double scale = dt * dt / (constants_.rest_density * std::max(1.0, unknowns));
    return solve::ConvergenceTest::measure(
        [scale](std::span<const double> residual) {
            double sum = 0;
            for (const double r : residual) sum += std::max(0.0, r);
            return sum * scale;
        },
        pressure.density_tolerance(), pressure.residual_tolerance());
}

// (S7)
void StepPressure::solve_system(const StepContext& parts, solve::Matrix& matrix, const PressureSystem::HostSystem& host,
    StepReport& report, double dt) {
    const auto rows = static_cast<std::size_t>(system_.rows());
    const auto test = convergence_test(report, dt);
    if (hierarchy_) hierarchy_->refer_to(parts.liquid, parts.solid);
    if (bounded(options_)) {
        report.pressure = complementarity_.solve(complementarity_parts(parts), matrix, host, test, report.pinned);
        report.misclassified = comm_.sum(complementarity_.misclassified());
    } else {
        report.pressure =
            solver_.solve(matrix, {host.right_hand_side.data(), rows}, {host.solution.data(), rows}, test);
    }
    system_.take_solution(host);
    if (!report.pressure.converged())
        fail(report.pressure, system_.global_rows(), "another method.pressure.preconditioner");
}

// (S7c)
void StepPressure::correct(const StepContext& parts, solve::Matrix& matrix, StepReport& report, double dt) {
    const auto corrected = correction_.correct({parts, matrix, solver_}, iisph_, dt);
    add_work(corrected, report.pressure);
    report.pressure.error_measure = corrected.error_measure;
}

void StepPressure::find_by_system(const PressureParts& parts, StepReport& report, double dt) {
    {
        const auto phase = parts.timers.scope("predict");
        predict_roles(parts, report, dt);
    }
    PressureSystem::HostSystem host;
    {
        const auto phase = parts.timers.scope("assemble");
        assemble(parts);
        host = system_.to_host();
    }
    auto& liquid = parts.step.liquid;
    solve::Matrix matrix(comm_, system_.blocks(host));
    if (implicit_bodies(options_, parts.bodies))
        matrix.set_matrix_free_term(response_.addition(comm_, liquid, system_));
    if (matrix_observer_) matrix_observer_(matrix);
    const auto phase = parts.timers.scope("solve");
    solve_system(parts.step, matrix, host, report, dt);
    system_.store_pressure(liquid);
    if (bounded(options_)) report.roles = count_roles(liquid);
    if (solids_unknown(options_)) system_.store_solid_pressure(parts.solid);
    if (options_.pressure.corrections > 0) correct(parts.step, matrix, report, dt);
}

// (IS1)
void StepPressure::find_by_iisph(const PressureParts& parts, StepReport& report, double dt) {
    const auto phase = parts.timers.scope("solve");
    const auto& step = parts.step;
    const auto first = report.pressure; // of DFSPH
    const bool answering = implicit_bodies(options_, parts.bodies);
    iisph_.set_coupling_term(answering ? &response_ : nullptr);
    iisph_.prepare_pairs(step);
    if (answering) response_.build(step, parts.bodies); // by gradients that may have been corrected
    report.pressure = iisph_.solve(step, dt, report.roles);
    iisph_.set_coupling_term(nullptr); // a shift of places does not move them
    add_work(first, report.pressure);
    last_pressures_ = LastPressures::known;
    if (!report.pressure.converged()) fail(report.pressure, particles(step), "method.pressure.solver: isph");
}

void StepPressure::solve(const PressureParts& parts, StepReport& report, double dt) {
    if (options_.pressure.solver == PressureSolver::isph) {
        find_by_system(parts, report, dt);
    } else {
        find_by_iisph(parts, report, dt);
    }
}

void StepPressure::shift(
    const StepContext& parts, const MomentReferencePoints& moment_reference_points, StepReport& report, double dt) {
    parts.halo.gather(parts.liquid.store, {parts.liquid.velocity_field()});
    const auto shifted = iisph_.shift(parts, dt);
    if (options_.pressure.wall_contact == WallContact::stop)
        stop_shift_at_walls(parts, {moment_reference_points, dt}, parts.liquid.acceleration());
    add_work(shifted, report.pressure);
    if (!shifted.converged()) fail(shifted, particles(parts), "method.pressure.recovery: velocities");
}

void StepPressure::remove_divergence(const PressureParts& parts, StepReport& report, double dt) {
    if (options_.pressure.solver != PressureSolver::dfsph) return;
    const auto phase = parts.timers.scope("solve");
    const auto& step = parts.step;
    report.pressure = iisph_.solve_divergence(step, dt, step.liquid.store.get<Array<double>>(divergence_field_));
    if (!report.pressure.converged()) fail(report.pressure, particles(step), "method.pressure.solver: isph");
    report.loads = apply_pressure(step, parts.bodies.moment_reference_points(), dt);
    step.halo.gather(step.liquid.store, {step.liquid.velocity_field()});
}

std::size_t StepPressure::bytes() const {
    return system_.bytes() + iisph_.bytes() + correction_.bytes() + (hierarchy_ ? hierarchy_->bytes() : 0);
}

} // namespace treacle::sph
