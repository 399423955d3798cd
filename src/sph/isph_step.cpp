#include "sph/isph_step.hpp"

#include "base/text/error.hpp"
#include "sph/forces/density.hpp"
#include "sph/forces/skin_friction.hpp"
#include "sph/forces/wall_contact.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace treacle::sph {

namespace {
// A solid particle costs little: only those near liquid are looked at.
constexpr double solid_weight = 0.05;

bool viscosity_by_operator(const IsphSetup& setup) {
    const auto integration = setup.options.viscosity.integration;
    return setup.forces.viscosity > 0 &&
           (integration == ViscosityIntegration::implicit || integration == ViscosityIntegration::explicit_form);
}
} // namespace

IsphStep::IsphStep(const Comm& comm, const IsphSetup& setup)
    : comm_(comm), setup_(setup), decomposition_(comm, setup.grid), iisph_(setup.forces.gravity),
      bodies_(setup.rigid, setup.solid_scale, setup.first_body, setup.bodies, setup.domain, setup.sides),
      hierarchy_(make_hierarchy(comm, setup.options, setup.constants, setup.domain, setup.grid)),
      solver_(comm, "pressure", krylov_options(setup.options, setup.constants.dimensions, hierarchy_.get())),
      complementarity_(comm, solver_.options()) {
    explicit_forces_ = setup.forces;
    if (viscosity_by_operator(setup)) {
        const auto& forces = setup.forces;
        viscosity_.emplace(comm, liquid_, setup.options.viscosity, setup.grid, forces.friction, forces.slip_length, forces.rheology);
        explicit_forces_.viscosity = 0;
    }
    if (setup.options.surface_tension.model != SurfaceTensionModel::none) {
        surface_tension_.emplace(liquid_, setup.options, setup.constants, setup.domain, setup.forces.surface_tension);
    }
    outlets_ = flow::make_outlets(setup.inflow.outlets, setup.domain.dimensions);
    if (!setup.inflow.inlets.empty()) inflow_.emplace(setup.inflow, setup.constants, setup.domain, liquid_);
    if (setup.options.pressure.solver != PressureSolver::dfsph) return;
    divergence_field_ = liquid_.store.add<Array<double>>("divergence_pressure", "Pa", FieldRole::state);
}

StepParts IsphStep::parts() {
    return {setup_.options, setup_.constants, comm_, liquid_, solid_, neighbours_, halo_, cells_, inflow_ || solid_speed() > 0};
}

ComplementarityParts IsphStep::complementarity_parts() {
    return {setup_.options, setup_.constants, comm_, liquid_, neighbours_, halo_, anchoring_};
}

void IsphStep::start(SolidVolumes volumes) {
    if (divergence_field_ >= 0 && volumes == SolidVolumes::compute) {
        Kokkos::deep_copy(liquid_.store.get<Array<double>>(divergence_field_), 0.0);
    }
    if (viscosity_ && volumes == SolidVolumes::compute) viscosity_->start(liquid_);
    recut();
    if (inflow_ && volumes == SolidVolumes::compute) {
        Kokkos::deep_copy(liquid_.inlet(), 0);
        inflow_->emit(liquid_, decomposition_);
    }
    place_liquid();
    place_solids();
    last_pressures_ = volumes == SolidVolumes::keep ? LastPressures::known : LastPressures::none;
    if (volumes == SolidVolumes::keep) return;
    bodies_.mark_start(solid_);
    bodies_.set_velocities(solid_);
    NeighbourList list;
    list.build(solid_.store, solid_.store, setup_.grid, solid_cells_, setup_.constants.support);
    compute_solid_volumes(setup_.options, setup_.constants, solid_, list, bodies_.load_points());
    solid_halo_.gather(solid_.store, {solid_.volume_field()});
}

void IsphStep::restore(std::span<const std::int64_t> state) {
    std::memcpy(&imbalance_after_cut_, state.data(), sizeof imbalance_after_cut_);
    decomposition_.restore(state.subspan(1));
    halo_.connect(decomposition_);
    solid_halo_.connect(decomposition_);
    place_liquid();
    place_solids();
}

std::vector<std::int64_t> IsphStep::decomposition_state() const {
    auto out = decomposition_.state();
    std::int64_t bits = 0;
    std::memcpy(&bits, &imbalance_after_cut_, sizeof bits);
    out.insert(out.begin(), bits);
    return out;
}

namespace {
// The cells of a store's particles with their weights. Liquid lies in the grid; a solid may reach beyond it and then
// counts for the nearest cell, whose rank owns it.
void append_weights(const ParticleStore& store, const CellGrid& grid, double weight, std::vector<int>& cells,
                    std::vector<double>& weights) {
    const auto x = on_host(store.position());
    int last[3] = {-1, -1, -1};
    for (int i = 0; i < store.owned(); ++i) {
        int c[3];
        grid.locate(x(i, 0), x(i, 1), x(i, 2), c);
        for (int k = 0; k < 3; ++k) c[k] = std::clamp(c[k], 0, grid.count[k] - 1);
        if (i > 0 && c[0] == last[0] && c[1] == last[1] && c[2] == last[2]) {
            weights.back() += weight; // sorted particles share their cell with the one before
            continue;
        }
        for (int k = 0; k < 3; ++k) {
            last[k] = c[k];
            cells.push_back(c[k]);
        }
        weights.push_back(weight);
    }
}

double load_imbalance(const Comm& comm, int particles) {
    const auto most = comm.max(static_cast<std::int64_t>(particles));
    const auto all = comm.sum(static_cast<std::int64_t>(particles));
    return all > 0 ? double(most) * comm.size() / double(all) : 1.0;
}
} // namespace

void IsphStep::recut() {
    if (comm_.size() > 1) {
        std::vector<int> cells;
        std::vector<double> weights;
        append_weights(liquid_.store, setup_.grid, 1.0, cells, weights);
        append_weights(solid_.store, setup_.grid, solid_weight, cells, weights);
        decomposition_.recut(cells, weights);
    }
    halo_.connect(decomposition_);
    solid_halo_.connect(decomposition_);
}

// With the particles at their owners, so that a cut does not depend on whether a frame was written before.
void IsphStep::rebalance() {
    if (comm_.size() == 1) return;
    const double imbalance = load_imbalance(comm_, liquid_.store.owned());
    // The best cut along cells may itself be uneven: cut again only when it has become worse than that.
    if (imbalance < setup_.options.rebalance_above || imbalance < 1.05 * imbalance_after_cut_) return;
    recut();
    place_liquid();
    place_solids();
    imbalance_after_cut_ = load_imbalance(comm_, liquid_.store.owned());
}

void IsphStep::place_liquid() {
    auto window = migration_.to_owner(liquid_.store, decomposition_).cells;
    if (solids_unknown()) window = decomposition_.box(); // solids look for liquid of other ranks as well
    sort_.sort(liquid_.store, setup_.grid, window, cells_);
    halo_.rebuild(liquid_.store, cells_);
}

void IsphStep::place_solids() {
    const auto occupied = migration_.to_owner(solid_.store, decomposition_).cells;
    // The whole box, not only the cells with solids: liquid anywhere in it meets the solids of other ranks, and it
    // moves on before the solids are placed anew.
    sort_.sort(solid_.store, setup_.grid, join(decomposition_.box(), occupied), solid_cells_);
    solid_halo_.rebuild(solid_.store, solid_cells_);
    solid_halo_.gather(solid_.store, {solid_.volume_field(), solid_.body_field(), solid_.velocity_field(), solid_.normal_field()});
}

void IsphStep::find_neighbours() {
    const double support = setup_.constants.support;
    neighbours_.liquid.build(liquid_.store, liquid_.store, setup_.grid, cells_, support);
    neighbours_.solid.build(liquid_.store, solid_.store, setup_.grid, solid_cells_, support);
    if (!solids_unknown()) return;
    solid_rows_.liquid.build(solid_.store, liquid_.store, setup_.grid, cells_, support);
    solid_rows_.solid.build(solid_.store, solid_.store, setup_.grid, solid_cells_, support);
}

bool IsphStep::solids_unknown() const {
    const auto& pressure = setup_.options.pressure;
    return pressure.solver == PressureSolver::isph && pressure.solid_term == SolidTerm::unknowns;
}

void IsphStep::update_density(StepReport& report) {
    compute_density(setup_.options, setup_.constants, liquid_, solid_, neighbours_);
    halo_.gather(liquid_.store, {liquid_.volume_field(), liquid_.velocity_field()});
    if (setup_.constants.mixture.several()) halo_.gather(liquid_.store, {liquid_.liquid_field()});
    if (inflow_) halo_.gather(liquid_.store, {liquid_.inlet_field()});
    const auto compression = measure_compression(setup_.constants, liquid_);
    report.mean_compression = compression.sum;
    report.max_compression = compression.max;
}

void IsphStep::refresh() {
    place_liquid();
    if (bodies_.any_moves()) place_solids();
    find_neighbours();
    compute_density(setup_.options, setup_.constants, liquid_, solid_, neighbours_);
    Kokkos::deep_copy(liquid_.role(), static_cast<int>(Role::poisson));
}

namespace {
bool bounded(const SphOptions& options) { return options.pressure.dirichlet == DirichletRule::complementarity; }

// Adds the work of another solve of the same step.
void add_work(const solve::SolveReport& other, solve::SolveReport& to) {
    to.iterations += other.iterations;
    to.products += other.products;
    to.iteration_seconds += other.iteration_seconds;
}

[[noreturn]] void fail(const solve::SolveReport& report, std::int64_t unknowns, const std::string& instead) {
    throw SimulationError({"pressure solve", report.reason,
                           "after " + std::to_string(report.iterations) + " iterations on " +
                               std::to_string(unknowns) + " unknowns",
                           "take a smaller time step, or " + instead});
}
} // namespace

void IsphStep::solve_pressure(solve::Matrix& matrix, const PressureSystem::HostSystem& host, double dt,
                              StepReport& report) {
    const auto rows = static_cast<std::size_t>(system_.rows());
    const auto& options = setup_.options.pressure;
    auto test = solve::ConvergenceTest::residual(options.residual);
    if (options.stop == StoppingRule::density_error) {
        // Mean compression that the residual leaves: r dt^2 is what the predicted density still exceeds rho0 by.
        const double unknowns = bounded(setup_.options) ? double(comm_.sum(report.roles.poisson))
                                                        : double(system_.global_rows());
        const double scale = dt * dt / (setup_.constants.rest_density * std::max(1.0, unknowns));
        test = solve::ConvergenceTest::measure(
            [scale](std::span<const double> residual) {
                double sum = 0;
                for (const double r : residual) sum += std::max(0.0, r);
                return sum * scale;
            },
            options.density_tolerance(), options.residual_tolerance());
    }
    if (hierarchy_) hierarchy_->refer_to(liquid_, solid_);
    if (bounded(setup_.options)) {
        report.pressure = complementarity_.solve(complementarity_parts(), matrix, host, test, report.anchored);
        report.misclassified = comm_.sum(complementarity_.misclassified());
    } else {
        report.pressure =
            solver_.solve(matrix, {host.right_hand_side.data(), rows}, {host.solution.data(), rows}, test);
    }
    system_.take_solution(host);
    if (!report.pressure.converged()) {
        fail(report.pressure, system_.global_rows(), "another method.pressure.preconditioner");
    }
}

void IsphStep::correct_pressures(solve::Matrix& matrix, double dt, StepReport& report) {
    const auto step = parts();
    const auto corrected = correction_.correct({step, matrix, solver_}, iisph_, dt);
    add_work(corrected, report.pressure);
    report.pressure.error_measure = corrected.error_measure;
}

namespace {
bool implicit_bodies(const SphOptions& options, const Bodies& bodies) {
    return bodies.any_dynamic() && options.pressure.body_coupling == BodyCoupling::implicit;
}
} // namespace

// (S4), for the liquid.
void IsphStep::accelerate(StepReport& report, double dt) {
    bodies_.rigid.begin(dt);
    bodies_.set_velocities(solid_);
    report.viscous_loads = apply_forces(setup_.options, explicit_forces_, setup_.constants, liquid_, solid_, neighbours_, dt,
                                        bodies_.load_points());
    apply_skin_friction(setup_.options, setup_.constants, liquid_, solid_, neighbours_,
                        {setup_.forces.skin_friction, bodies_.load_points(), dt}, report.viscous_loads);
    if (surface_tension_) surface_tension_->accelerate(parts(), dt);
    if (inflow_) inflow_->hold(liquid_);
}

// (V)
void IsphStep::apply_viscosity(StepReport& report, double dt) {
    const auto phase = timers_.scope("viscosity");
    if (give_way()) {
        bodies_.rigid.fall(dt);
        push_by_viscosity(report.viscous_loads, dt);
    }
    auto result = viscosity_->solve({parts(), setup_.forces, &solid_halo_}, bodies_, dt);
    report.viscosity = result.solve;
    if (!result.solve.converged()) {
        throw SimulationError({"viscosity solve", result.solve.reason,
                               "after " + std::to_string(result.solve.iterations) + " iterations",
                               "take a smaller time step or a larger method.viscosity.residual"});
    }
    if (give_way()) push_by_viscosity(result.loads, dt);
    for (std::size_t k = 0; k < result.loads.size(); ++k) report.viscous_loads[k] += result.loads[k];
}

// Whether dynamic bodies are unknowns of the viscous solve.
bool IsphStep::give_way() const {
    const auto& options = setup_.options.viscosity;
    return viscosity_ && bodies_.any_dynamic() && options.integration == ViscosityIntegration::implicit &&
           options.body_coupling == BodyCoupling::implicit;
}

void IsphStep::push_by_viscosity(BodyLoads& loads, double dt) {
    comm_.sum(std::span(loads));
    bodies_.rigid.push(bodies_.loads_of(loads), dt);
    bodies_.set_velocities(solid_);
}

// (S4), for the bodies.
void IsphStep::accelerate_bodies(StepReport& report, double dt) {
    halo_.gather(liquid_.store, {liquid_.velocity_field(), liquid_.pressure_field()});
    if (!bodies_.any_dynamic() || give_way()) return;
    bodies_.rigid.fall(dt);
    push_by_viscosity(report.viscous_loads, dt);
}

void IsphStep::assemble_system() {
    if (solids_unknown()) {
        system_.assemble_joint(setup_.options, setup_.constants, comm_,
                               {liquid_, solid_, neighbours_, solid_rows_, halo_, solid_halo_});
    } else {
        system_.assemble(setup_.options, setup_.constants, comm_, liquid_, neighbours_, halo_);
    }
}

void IsphStep::find_pressures(StepReport& report, double dt) {
    const auto& options = setup_.options;
    const auto& constants = setup_.constants;
    const bool answering = implicit_bodies(options, bodies_);
    {
        const auto phase = timers_.scope("predict");
        if (answering) {
            response_.build(options, constants, liquid_, solid_, neighbours_, bodies_);
            response_.apply_to_pressure(comm_, liquid_);
        }
        report.roles = predict(options, constants, liquid_, solid_, neighbours_, last_pressures_, dt,
                               answering ? Answer::bodies : Answer::none); // (S5), (S6)
        last_pressures_ = LastPressures::known;
        if (inflow_) {
            inflow_->close(liquid_);
            report.roles = count_roles(liquid_);
        }
        halo_.gather(liquid_.store, {liquid_.role_field()});
        if (solids_unknown()) {
            report.roles.poisson += solid_rows_.predict(options, constants, liquid_, solid_, neighbours_, solid_halo_);
        }
        report.anchored = bounded(options) ? complementarity_.anchor(complementarity_parts())
                                           : anchoring_.anchor(options, constants, comm_, liquid_, neighbours_, halo_);
    }
    PressureSystem::HostSystem host;
    {
        const auto phase = timers_.scope("assemble");
        assemble_system();
        host = system_.to_host();
    }
    {
        solve::Matrix matrix(comm_, system_.blocks(host));
        if (answering) matrix.set_addition(response_.addition(comm_, liquid_, system_));
        if (matrix_observer_) matrix_observer_(matrix);
        const auto phase = timers_.scope("solve");
        solve_pressure(matrix, host, dt, report); // (S7)
        system_.store_pressure(liquid_);
        if (bounded(options)) report.roles = count_roles(liquid_);
        if (solids_unknown()) system_.store_solid_pressure(solid_);
        if (options.pressure.corrections > 0) correct_pressures(matrix, dt, report); // (S7c)
    }
}

void IsphStep::find_pressures_by_iisph(StepReport& report, double dt) {
    const auto phase = timers_.scope("solve");
    const auto first = report.pressure; // of DFSPH
    const bool answering = implicit_bodies(setup_.options, bodies_);
    if (answering) response_.build(setup_.options, setup_.constants, liquid_, solid_, neighbours_, bodies_);
    iisph_.give_way(answering ? &response_ : nullptr);
    report.pressure = iisph_.solve(parts(), dt, report.roles);
    iisph_.give_way(nullptr); // a shift of places does not move them
    add_work(first, report.pressure);
    last_pressures_ = LastPressures::known;
    if (report.pressure.converged()) return;
    fail(report.pressure, comm_.sum(static_cast<std::int64_t>(liquid_.store.owned())), "method.pressure.solver: isph");
}

// (I2) Where the velocities leave liquid that is compressed, the particles move on by more than their velocities.
void IsphStep::shift_positions(const StepParts& parts, StepReport& report, double dt) {
    const auto phase = timers_.scope("solve");
    halo_.gather(liquid_.store, {liquid_.velocity_field()});
    const auto shifted = iisph_.shift(parts, dt);
    if (setup_.options.pressure.wall_contact == WallContact::stop) {
        stop_shift_at_walls(parts, {bodies_.load_points(), dt}, liquid_.acceleration());
    }
    add_work(shifted, report.pressure);
    if (shifted.converged()) return;
    fail(shifted, comm_.sum(static_cast<std::int64_t>(liquid_.store.owned())), "method.pressure.recovery: velocities");
}

// (I2) Moves what stands too close apart, at rest, until the mean compression is below that of the rule; at most so many times.
void IsphStep::spread(int times) {
    constexpr double close_compression = 0.05; // of liquid half a spacing off corners of solids: 0.04
    constexpr double dt = 1e-9; // [s]; in which no velocity leads anywhere: places follow from places
    SphOptions options = setup_.options;
    options.pressure.stop = StoppingRule::density_error; // a start needs no more than that
    const StepParts loose{options, setup_.constants, comm_, liquid_, solid_, neighbours_, halo_, cells_};
    for (int k = 0; k < times; ++k) {
        StepReport report;
        place_liquid();
        find_neighbours();
        update_density(report);
        const double count = comm_.sum(double(liquid_.store.owned()));
        if (k == 0 && comm_.max(report.max_compression) <= close_compression) return;
        if (comm_.sum(report.mean_compression) <= setup_.options.pressure.density_tolerance() * count) return;
        iisph_.prepare_pairs(loose);
        shift_positions(loose, report, dt);
        move_particles(setup_.domain, liquid_, dt, Use::yes);
    }
}

// The divergence-free solve of DFSPH: of the last step, at the places that it led to.
void IsphStep::remove_divergence(StepReport& report, double dt) {
    const auto phase = timers_.scope("solve");
    const auto& last = liquid_.store.get<Array<double>>(divergence_field_);
    report.pressure = iisph_.solve_divergence(parts(), dt, last);
    if (!report.pressure.converged()) {
        const auto particles = comm_.sum(static_cast<std::int64_t>(liquid_.store.owned()));
        fail(report.pressure, particles, "method.pressure.solver: isph");
    }
    report.loads = apply_pressure(setup_.options, setup_.constants, liquid_, solid_, neighbours_,
                                  bodies_.load_points(), dt);
    halo_.gather(liquid_.store, {liquid_.velocity_field()});
}

// (S8)
void IsphStep::push_by_pressure(StepReport& report, double dt) {
    compute_loads(setup_.constants, liquid_);
    halo_.gather(liquid_.store, {liquid_.load_field()});
    auto loads = apply_pressure(setup_.options, setup_.constants, liquid_, solid_, neighbours_,
                                bodies_.load_points(), dt);
    for (std::size_t k = 0; k < report.loads.size(); ++k) loads[k] += report.loads[k]; // of DFSPH's other solve
    if (setup_.options.pressure.wall_contact == WallContact::stop) {
        report.stopped = stop_at_walls(setup_.constants, liquid_, solid_, neighbours_, {bodies_.load_points(), dt}, loads);
    }
    report.loads = std::move(loads);
    if (inflow_) inflow_->hold(liquid_);
    if (!bodies_.any_dynamic()) return;
    comm_.sum(std::span(report.loads));
    bodies_.rigid.push(bodies_.loads_of(report.loads), dt);
}

// (S9)
void IsphStep::move(StepReport& report, double dt) {
    const bool smooth = setup_.options.viscosity.xsph > 0;
    if (smooth) {
        halo_.gather(liquid_.store, {liquid_.velocity_field()});
        compute_xsph(setup_.options, setup_.constants, liquid_, solid_, neighbours_);
        clear_held(liquid_, liquid_.acceleration());
    }
    const bool shifts = setup_.options.pressure.recovers_places();
    const auto gone = move_particles(setup_.domain, liquid_, dt, smooth || shifts ? Use::yes : Use::no);
    if (bodies_.any_moves()) {
        bodies_.rigid.move(dt);
        bodies_.place(solid_);
    }
    if (inflow_) inflow_->pass(liquid_, dt);
    report.imbalance = load_imbalance(comm_, liquid_.store.owned());
    if (gone.outflow > 0 || outlets_.count > 0) {
        report.lost_by_cause[0] = remove_outflow(setup_.domain, outlets_, liquid_);
    }
    if (gone.lost > 0) report.lost = remove_lost(setup_.domain, liquid_);
    collect(report);
}

// One hybrid ISPH step, collective. Tags: src/sph/README.md.
StepReport IsphStep::advance(double dt) {
    StepReport report;
    report.dt = dt;
    {
        const auto phase = timers_.scope("sort");
        if (inflow_) inflow_->emit(liquid_, decomposition_);
        place_liquid();
        rebalance();
        if (bodies_.any_moves()) place_solids();
    }
    {
        const auto phase = timers_.scope("neighbours");
        find_neighbours();
    }
    {
        const auto phase = timers_.scope("density");
        update_density(report); // (S1)-(S3)
    }
    if (setup_.options.pressure.solver == PressureSolver::dfsph) remove_divergence(report, dt);
    {
        const auto phase = timers_.scope("forces");
        accelerate(report, dt); // (S4)
    }
    if (viscosity_) apply_viscosity(report, dt);
    {
        const auto phase = timers_.scope("forces");
        accelerate_bodies(report, dt);
    }
    if (setup_.options.pressure.solver == PressureSolver::isph) {
        find_pressures(report, dt); // (S5)-(S7)
    } else {
        find_pressures_by_iisph(report, dt); // (I)
    }
    {
        const auto phase = timers_.scope("pressure force");
        push_by_pressure(report, dt);
    }
    if (setup_.options.pressure.recovers_places()) shift_positions(parts(), report, dt);
    {
        const auto phase = timers_.scope("move");
        move(report, dt);
    }
    return report;
}

// Sums the report over the ranks, in one message.
void IsphStep::collect(StepReport& report) {
    for (const auto& particle : report.lost) {
        ++report.lost_by_cause[static_cast<std::size_t>(particle.cause) - 1];
    }
    std::vector<double> sums;
    if (!bodies_.any_dynamic()) { // else they are summed already
        sums = report.loads;
        sums.insert(sums.end(), report.viscous_loads.begin(), report.viscous_loads.end());
    }
    const std::size_t n = sums.size();
    const double lost_before = double(report.lost.size()) + double(report.lost_by_cause[0]);
    for (const auto count : {report.roles.poisson, report.roles.dirichlet, report.roles.separated, report.anchored, report.stopped}) {
        sums.push_back(double(count));
    }
    for (const auto count : report.lost_by_cause) sums.push_back(double(count));
    sums.push_back(report.mean_compression);
    sums.push_back(double(liquid_.store.owned()) + lost_before);
    comm_.sum(std::span(sums));
    report.max_compression = comm_.max(report.max_compression);
    if (n > 0) {
        std::copy_n(sums.begin(), report.loads.size(), report.loads.begin());
        std::copy_n(sums.begin() + std::ptrdiff_t(report.loads.size()), report.viscous_loads.size(),
                    report.viscous_loads.begin());
    }
    const auto count = [&](std::size_t k) { return static_cast<std::int64_t>(std::llround(sums[n + k])); };
    report.roles = {count(0), count(1), count(2)};
    report.anchored = count(3);
    report.stopped = count(4);
    for (std::size_t k = 0; k < loss_causes; ++k) report.lost_by_cause[k] = count(5 + k);
    report.mean_compression = sums[n + 5 + loss_causes] / std::max(1.0, sums[n + 6 + loss_causes]);
}

double IsphStep::solid_speed() const {
    double most = bodies_.rigid.max_speed();
    for (const auto& velocity : setup_.sides) most = std::max(most, std::hypot(velocity[0], velocity[1], velocity[2]));
    return most;
}

double IsphStep::stable_step(double cfl) const {
    const auto u = liquid_.velocity();
    double fastest = 0;
    Kokkos::parallel_reduce("treacle::fastest", liquid_.store.owned(), KOKKOS_LAMBDA(int i, double& most) {
        most = math::max(most, u(i, 0) * u(i, 0) + u(i, 1) * u(i, 1) + u(i, 2) * u(i, 2));
    }, Kokkos::Max<double>(fastest));
    const double own = std::sqrt(liquid_.store.owned() > 0 ? fastest : 0.0);
    const double inflow = inflow_ ? inflow_->max_speed() : 0;
    const double speed = comm_.max(std::max({own, setup_.reference_speed, solid_speed(), inflow}));
    const auto& g = setup_.forces.gravity;
    const double pull = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    const double d = setup_.constants.spacing;
    double dt = viscous_step_limit(setup_.options.viscosity, setup_.constants, setup_.forces.viscosity);
    dt = std::min(dt, capillary_step_limit(setup_.options.surface_tension, setup_.constants, setup_.forces.surface_tension));
    cfl *= setup_.constants.mixture.step_share;
    if (speed > 0) dt = std::min(dt, cfl * d / speed);
    if (pull > 0) dt = std::min(dt, cfl * std::sqrt(d / pull));
    return dt;
}

std::size_t IsphStep::bytes() const {
    return liquid_.bytes() + solid_.store.bytes() + neighbours_.liquid.bytes() + neighbours_.solid.bytes() +
           system_.bytes() + iisph_.bytes() + correction_.bytes() + (viscosity_ ? viscosity_->bytes() : 0) + (hierarchy_ ? hierarchy_->bytes() : 0);
}

} // namespace treacle::sph
