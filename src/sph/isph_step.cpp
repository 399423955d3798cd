#include "sph/isph_step.hpp"

#include "base/text/error.hpp"
#include "sph/forces/density.hpp"
#include "sph/forces/end_velocity.hpp"
#include "sph/forces/motion.hpp"
#include "sph/forces/skin_friction.hpp"
#include "sph/forces/wall_contact.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::sph {

namespace {
// A solid particle costs little: only those near liquid are processed.
constexpr double solid_weight = 0.05;

bool viscosity_by_operator(const IsphSetup& setup) {
    const auto integration = setup.options.viscosity.integration;
    return setup.forces.viscosity > 0 &&
           (integration == ViscosityIntegration::implicit || integration == ViscosityIntegration::explicit_form);
}

// True when bodies or sides can push the liquid.
bool solids_may_move(const IsphSetup& setup) {
    const auto moves = [](const auto& body) { return body.kind != scene::BodyKind::fixed; };
    const auto slides = [](const Vec3& velocity) { return velocity != Vec3{0, 0, 0}; };
    return std::ranges::any_of(setup.rigid.bodies, moves) || std::ranges::any_of(setup.sides, slides);
}

// The setup with `gradients: automatic` decided.
IsphSetup decided(IsphSetup setup) {
    auto& pressure = setup.options.pressure;
    if (pressure.gradients == PressureGradients::automatic)
        pressure.gradients = pressure.may_correct_gradients() && solids_may_move(setup) ? PressureGradients::corrected
                                                                                        : PressureGradients::kernel;
    return setup;
}
} // namespace

IsphStep::IsphStep(const Comm& comm, const IsphSetup& setup)
    : comm_(comm), setup_(decided(setup)), decomposition_(comm, setup.grid),
      load_balance_(setup.options.max_load_imbalance),
      bodies_(setup.rigid, setup.boundary_volume_factor, setup.first_body, setup.bodies, setup.domain, setup.sides),
      pressure_(comm, setup_.options, setup.constants, setup.domain, setup.grid, setup.forces.gravity) {
    explicit_forces_ = setup.forces;
    if (setup_.options.pressure.corrects_gradients()) liquid_.add_gradient_correction();
    if (viscosity_by_operator(setup)) {
        const auto& forces = setup.forces;
        viscosity_.emplace(
            comm, liquid_, setup.options.viscosity, setup.grid, forces.friction, forces.slip_length, forces.rheology);
        explicit_forces_.viscosity = 0;
    }
    if (setup.options.surface_tension.model != SurfaceTensionModel::none) {
        surface_tension_.emplace(liquid_, setup.options, setup.constants, setup.domain, setup.forces.surface_tension);
    }
    outlets_ = flow::make_outlets(setup.inflow.outlets, setup.domain.dimensions);
    if (!setup.inflow.inlets.empty()) inflow_.emplace(setup.inflow, setup.constants, setup.domain, liquid_);
    pressure_.add_fields(liquid_);
}

StepContext IsphStep::parts() {
    return {setup_.options, setup_.constants, comm_, liquid_, solid_, neighbours_, halo_, cells_,
        inflow_ || solid_speed() > 0};
}

PressureParts IsphStep::pressure_parts() {
    return {parts(), solid_, solid_halo_, setup_.grid, solid_cells_, bodies_, inflow_ ? &*inflow_ : nullptr, timers_};
}

void IsphStep::start(SolidVolumes volumes) {
    pressure_.start(liquid_, volumes == SolidVolumes::keep ? LastPressures::known : LastPressures::none);
    if (viscosity_ && volumes == SolidVolumes::compute) viscosity_->start(liquid_);
    repartition();
    if (inflow_ && volumes == SolidVolumes::compute) {
        Kokkos::deep_copy(liquid_.inlet(), 0);
        inflow_->emit(liquid_, decomposition_);
    }
    distribute_liquid();
    distribute_solids();
    if (!(before_ > 0)) begin_motion();
    if (volumes == SolidVolumes::keep) return;
    bodies_.mark_start(solid_);
    bodies_.set_velocities(solid_);
    NeighbourList list;
    list.build(solid_.store, solid_.store, setup_.grid, solid_cells_, setup_.constants.support);
    compute_solid_volumes(setup_.options, setup_.constants, solid_, list, bodies_.moment_reference_points());
    solid_halo_.gather(solid_.store, {solid_.volume_field()});
}

void IsphStep::restore(std::span<const std::int64_t> state) {
    load_balance_.restore(state, decomposition_);
    halo_.connect(decomposition_);
    solid_halo_.connect(decomposition_);
    distribute_liquid();
    distribute_solids();
}

std::vector<std::int64_t> IsphStep::decomposition_state() const { return load_balance_.state(decomposition_); }

void IsphStep::repartition() {
    if (comm_.size() > 1) {
        load_balance_.add(liquid_.store, setup_.grid);
        load_balance_.add(solid_.store, setup_.grid, solid_weight);
        load_balance_.cut(decomposition_);
    }
    halo_.connect(decomposition_);
    solid_halo_.connect(decomposition_);
}

// With the particles at their owners, so that a cut does not depend on whether a frame was written before.
void IsphStep::rebalance() {
    if (!load_balance_.is_due(comm_, liquid_.store.owned())) return;
    repartition();
    distribute_liquid();
    distribute_solids();
    load_balance_.note_cut(comm_, liquid_.store.owned());
}

void IsphStep::distribute_liquid() {
    auto window = migration_.to_owner(liquid_.store, decomposition_).cells;
    if (solids_unknown(setup_.options))
        window = decomposition_.box(); // solids have liquid of other ranks as neighbours
    sort_.sort(liquid_.store, setup_.grid, window, cells_);
    halo_.rebuild(liquid_.store, cells_);
}

void IsphStep::distribute_solids() {
    const auto occupied = migration_.to_owner(solid_.store, decomposition_).cells;
    // The whole box, not only the cells with solids: liquid anywhere in it may be near the solids of other ranks, and
    // it moves on before the solids are placed anew.
    sort_.sort(solid_.store, setup_.grid, join(decomposition_.box(), occupied), solid_cells_);
    solid_halo_.rebuild(solid_.store, solid_cells_);
    solid_halo_.gather(
        solid_.store, {solid_.volume_field(), solid_.body_field(), solid_.velocity_field(), solid_.normal_field()});
}

void IsphStep::find_neighbours() {
    const double support = setup_.constants.support;
    neighbours_.liquid.build(liquid_.store, liquid_.store, setup_.grid, cells_, support);
    neighbours_.solid.build(liquid_.store, solid_.store, setup_.grid, solid_cells_, support);
}

void IsphStep::update_density(StepReport& report) {
    compute_density(setup_.options, setup_.constants, liquid_, solid_, neighbours_);
    halo_.gather(liquid_.store, {liquid_.volume_field(), liquid_.velocity_field()});
    if (setup_.constants.immiscible.several()) halo_.gather(liquid_.store, {liquid_.liquid_field()});
    if (inflow_) halo_.gather(liquid_.store, {liquid_.inlet_field()});
    const auto compression = measure_compression(setup_.constants, liquid_);
    report.mean_compression = compression.sum;
    report.max_compression = compression.max;
}

void IsphStep::refresh() {
    distribute_liquid();
    if (bodies_.any_moves()) distribute_solids();
    find_neighbours();
    compute_density(setup_.options, setup_.constants, liquid_, solid_, neighbours_);
    Kokkos::deep_copy(liquid_.role(), static_cast<int>(Role::poisson));
}

// (S4), for the liquid.
void IsphStep::accelerate(StepReport& report, double dt) {
    bodies_.set_velocities(solid_);
    report.viscous_loads = apply_forces(parts(), explicit_forces_, dt, bodies_.moment_reference_points());
    apply_skin_friction(
        parts(), {setup_.forces.skin_friction, bodies_.moment_reference_points(), dt}, report.viscous_loads);
    if (surface_tension_) surface_tension_->accelerate(parts(), dt);
    if (inflow_) inflow_->prescribe(liquid_);
}

// (S4v)
void IsphStep::apply_viscosity(StepReport& report, double dt) {
    const auto phase = timers_.scope("viscosity");
    if (strongly_coupled()) {
        bodies_.rigid.fall(dt);
        push_by_viscosity(report.viscous_loads, dt);
    }
    auto result = viscosity_->solve({parts(), setup_.forces, &solid_halo_}, bodies_, dt);
    report.viscosity = result.solve;
    if (!result.solve.converged()) {
        throw SimulationError(
            {"viscosity solve", result.solve.reason, "after " + std::to_string(result.solve.iterations) + " iterations",
                "take a smaller time step or a larger method.viscosity.residual"});
    }
    if (strongly_coupled()) push_by_viscosity(result.loads, dt);
    for (std::size_t k = 0; k < result.loads.size(); ++k) report.viscous_loads[k] += result.loads[k];
}

// True when dynamic bodies are unknowns of the viscous solve.
bool IsphStep::strongly_coupled() const {
    const auto& options = setup_.options.viscosity;
    return viscosity_ && bodies_.any_dynamic() && options.integration == ViscosityIntegration::implicit &&
           options.coupling == BodyCoupling::strong;
}

void IsphStep::push_by_viscosity(BodyLoads& loads, double dt) {
    comm_.sum(std::span(loads));
    bodies_.rigid.push(bodies_.loads_of(loads), dt);
    bodies_.set_velocities(solid_);
}

// (S4), for the bodies.
void IsphStep::accelerate_bodies(StepReport& report, double dt) {
    halo_.gather(liquid_.store, {liquid_.velocity_field(), liquid_.pressure_field()});
    if (!bodies_.any_dynamic() || strongly_coupled()) return;
    bodies_.rigid.fall(dt);
    push_by_viscosity(report.viscous_loads, dt);
}

// (IS2) Moves what stands too close apart, at rest, until the mean compression is below that of the rule; at most so many times.
void IsphStep::spread(int times) {
    constexpr double close_compression = 0.05; // of liquid half a spacing off corners of solids: 0.04
    constexpr double dt = 1e-9;                // [s]; in which no velocity leads anywhere: places follow from places
    SphOptions options = setup_.options;
    options.pressure.stop = StoppingRule::density_error; // a start needs no more than that
    const StepContext loose{options, setup_.constants, comm_, liquid_, solid_, neighbours_, halo_, cells_};
    for (int k = 0; k < times; ++k) {
        StepReport report;
        distribute_liquid();
        find_neighbours();
        update_density(report);
        const double count = comm_.sum(double(liquid_.store.owned()));
        if (k == 0 && comm_.max(report.max_compression) <= close_compression) return;
        if (comm_.sum(report.mean_compression) <= setup_.options.pressure.density_tolerance() * count) return;
        pressure_.prepare_shift(loose);
        pressure_.shift(loose, bodies_.moment_reference_points(), report, dt);
        move_particles(setup_.domain, liquid_, dt, Use::yes);
    }
}

// (S8)
void IsphStep::push_by_pressure(StepReport& report, double dt) {
    compute_pressure_over_density2(setup_.constants, liquid_);
    halo_.gather(liquid_.store, {liquid_.load_field()});
    auto loads = apply_pressure(parts(), bodies_.moment_reference_points(), dt);
    for (std::size_t k = 0; k < report.loads.size(); ++k) loads[k] += report.loads[k]; // of DFSPH's other solve
    if (setup_.options.pressure.wall_contact == WallContact::stop) {
        report.stopped = stop_at_walls(parts(), {bodies_.moment_reference_points(), dt}, loads);
    }
    report.loads = std::move(loads);
    if (inflow_) inflow_->prescribe(liquid_);
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
        clear_prescribed(liquid_, liquid_.acceleration());
    }
    const bool shifts = setup_.options.pressure.recovers_positions();
    const auto gone = move_particles(setup_.domain, liquid_, dt, smooth || shifts ? Use::yes : Use::no);
    if (bodies_.any_moves()) {
        bodies_.rigid.move(dt);
        bodies_.update_positions(solid_);
    }
    if (inflow_) inflow_->pass(liquid_, dt);
    report.imbalance = load_imbalance(comm_, liquid_.store.owned());
    if (gone.outflow > 0 || outlets_.count > 0) {
        report.lost_by_cause[0] = remove_outflow(setup_.domain, outlets_, liquid_);
    }
    if (gone.lost > 0) report.lost = remove_lost(setup_.domain, liquid_);
    collect(report);
}

void IsphStep::emit() {
    if (!inflow_) return;
    const int before = liquid_.store.owned();
    inflow_->emit(liquid_, decomposition_);
    begin_velocities(liquid_, before, setup_.forces.gravity);
}

// One hybrid ISPH step, collective. Velocities are those of the middles of steps: forces act from one to the next, and move
// the particles by the step. Tags: src/sph/README.md.
StepReport IsphStep::advance(double dt) {
    StepReport report;
    report.dt = dt;
    // Pressures that recover the density in velocities count on these as the motion of the step, as published.
    const bool middles = setup_.options.pressure.recovers_positions();
    const flow::StepTimes times{middles ? 0.5 * (before_ + dt) : dt, dt};
    const double kick = times.kick;
    {
        const auto phase = timers_.scope("sort");
        emit();
        distribute_liquid();
        rebalance();
        if (bodies_.any_moves()) distribute_solids();
        note_velocities(liquid_);
    }
    {
        const auto phase = timers_.scope("neighbours");
        find_neighbours();
    }
    {
        const auto phase = timers_.scope("density");
        update_density(report); // (S1)-(S3)
    }
    pressure_.remove_divergence(pressure_parts(), report, kick);
    {
        const auto phase = timers_.scope("forces");
        bodies_.rigid.begin(dt);
        accelerate(report, kick); // (S4)
    }
    if (viscosity_) apply_viscosity(report, kick);
    {
        const auto phase = timers_.scope("forces");
        accelerate_bodies(report, kick);
    }
    pressure_.solve(pressure_parts(), report, kick); // (S5)-(S7) or (IS1)
    {
        const auto phase = timers_.scope("pressure force");
        push_by_pressure(report, kick);
    }
    if (setup_.options.pressure.recovers_positions()) {
        const auto phase = timers_.scope("solve");
        pressure_.shift(parts(), bodies_.moment_reference_points(), report, dt); // (IS2)
    }
    {
        const auto phase = timers_.scope("move");
        move(report, dt);
        end_motion(times);
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
    for (const auto count :
        {report.roles.poisson, report.roles.dirichlet, report.roles.separated, report.pinned, report.stopped}) {
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
    report.pinned = count(3);
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
    Kokkos::parallel_reduce(
        "treacle::fastest", liquid_.store.owned(),
        KOKKOS_LAMBDA(
            int i, double& most) { most = math::max(most, u(i, 0) * u(i, 0) + u(i, 1) * u(i, 1) + u(i, 2) * u(i, 2)); },
        Kokkos::Max<double>(fastest));
    const double own = std::sqrt(liquid_.store.owned() > 0 ? fastest : 0.0);
    const double inflow = inflow_ ? inflow_->max_speed() : 0;
    const double speed = comm_.max(std::max({own, setup_.reference_speed, solid_speed(), inflow}));
    const auto& g = setup_.forces.gravity;
    const double pull = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    const double d = setup_.constants.spacing;
    double dt = viscous_step_limit(setup_.options.viscosity, setup_.constants, setup_.forces.viscosity);
    dt = std::min(
        dt, capillary_step_limit(setup_.options.surface_tension, setup_.constants, setup_.forces.surface_tension));
    cfl *= setup_.constants.immiscible.time_step_factor;
    if (speed > 0) dt = std::min(dt, cfl * d / speed);
    if (pull > 0) dt = std::min(dt, cfl * std::sqrt(d / pull));
    return dt;
}

std::size_t IsphStep::bytes() const {
    return liquid_.bytes() + solid_.store.bytes() + neighbours_.liquid.bytes() + neighbours_.solid.bytes() +
           pressure_.bytes() + (viscosity_ ? viscosity_->bytes() : 0);
}

} // namespace treacle::sph
