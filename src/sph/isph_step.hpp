#pragma once
#include "base/timers.hpp"
#include "flow/end_motion.hpp"
#include "mpi/load_balance.hpp"
#include "mpi/migration.hpp"
#include "sph/forces/forces.hpp"
#include "sph/forces/inflow.hpp"
#include "sph/solids/bodies.hpp"
#include "sph/step_pressure.hpp"
#include "sph/step_report.hpp"
#include "sph/surface_tension/surface_tension.hpp"
#include "sph/viscosity/implicit_viscosity.hpp"

#include <optional>

namespace treacle::sph {

// Constants of a run.
struct IsphSetup {
    SphOptions options;
    Constants constants;
    ForceOptions forces;
    DomainBox domain;
    CellGrid grid;
    double reference_speed = 0; // sqrt(g H): the speed at which the weight of the liquid acts on it [m/s]
    int bodies = 1;             // solids that carry loads; 0 is the domain's walls
    rigid::BodiesSetup rigid;   // may be empty: then all solids rest
    std::vector<double> boundary_volume_factor; // per body of `rigid`, or empty: factor on its particles' volumes
    flow::InflowSetup inflow;
    std::vector<Vec3> sides; // [m/s] velocities of the domain's sides along themselves; empty: they rest
    int first_body = 0;      // number, among the solids that carry loads, of the first of these bodies
};

// Hybrid incompressible SPH (dissertation, Algorithms 1 and 2), collective over the decomposition's ranks.
class IsphStep {
public:
    IsphStep(const Comm& comm, const IsphSetup& setup);

    // State of the run on this rank: particles, owned ones before ghosts; constants; decomposition; phase times [s];
    // pressure system and neighbours of the last step.
    LiquidParticles& liquid() { return liquid_; }
    const LiquidParticles& liquid() const { return liquid_; }
    SolidParticles& solid() { return solid_; }
    const SolidParticles& solid() const { return solid_; }
    const IsphSetup& setup() const { return setup_; }
    const rigid::RigidBodies& bodies() const { return bodies_.rigid; }
    const Comm& comm() const { return comm_; }
    const Decomposition& decomposition() const { return decomposition_; }
    PhaseTimers& timers() { return timers_; }
    const PhaseTimers& timers() const { return timers_; }
    const PressureSystem& system() const { return pressure_.system(); }
    const Neighbourhood& neighbours() const { return neighbours_; }

    // Collective: to be called when particles have been put into the stores, on whatever rank. Cuts the domain,
    // sends particles to their owners, and computes the volumes of solid particles unless they are kept, as from
    // a checkpoint.
    enum class SolidVolumes { compute, keep };
    // Collective, before the first step, with `recovery: positions`: moves liquid that has been seeded too close to solids away.
    void spread(int times);
    void start(SolidVolumes volumes = SolidVolumes::compute);
    // As start, with the decomposition's state of a checkpoint of the same number of ranks.
    void restore(std::span<const std::int64_t> state);
    // The bodies as a checkpoint has them; before start() or restore().
    void restore_bodies(std::span<const double> state) { bodies_.rigid.restore(state); }
    std::vector<std::int64_t> decomposition_state() const;
    // The last step and the inlets as a checkpoint has them; before start() or restore(), after restore_bodies().
    std::vector<double> history() const;
    void restore_history(std::span<const double> state);
    // Totals of the liquid at the end of the last step, collective.
    LiquidTotals totals() const;
    // Particles that flowed in since the start of the run, over all ranks.
    std::int64_t emitted() const { return inflow_ ? inflow_->emitted() : 0; }

    // One step of dt [s]. Throws SimulationError, on every rank, when the pressure solve fails.
    StepReport advance(double dt);

    // Collective: brings the density of the owned particles up to date with their positions, for output.
    void refresh();

    // Largest step in which no particle moves farther than `cfl` spacings at its speed or the reference speed, which
    // bounds what the pressure must hold up, no body that moves does either, and the limits of the explicit viscosity and of
    // the surface tension [s].
    // With several liquids ImmiscibleLiquids::step_share of the first of these.
    double stable_step(double cfl) const;

    // StepPressure::observe_matrix, for measurements.
    void observe_matrix(StepPressure::MatrixObserver observer) { pressure_.observe_matrix(std::move(observer)); }

    // Bytes that this rank's particles, lists and matrix take.
    std::size_t bytes() const;

private:
    void emit();
    void rebalance();
    void repartition();
    void distribute_liquid();
    void distribute_solids();
    void find_neighbours();
    void update_density(StepReport& report);
    void accelerate(StepReport& report, double dt);
    void apply_viscosity(StepReport& report, double dt);
    bool strongly_coupled() const;
    void push_by_viscosity(BodyLoads& loads, double dt);
    void accelerate_bodies(StepReport& report, double dt);
    void push_by_pressure(StepReport& report, double dt);
    void move(StepReport& report, double dt);
    void collect(StepReport& report);
    void begin_motion();
    void end_motion(const flow::StepTimes& times);
    flow::EndMotion::Middle middle_motion() const;
    StepContext parts();
    PressureParts pressure_parts();
    double solid_speed()
        const; // bound of the speeds of bodies that move and of the domain's sides [m/s]; the same on all ranks

    Comm comm_;
    IsphSetup setup_;
    LiquidParticles liquid_;
    SolidParticles solid_;
    Decomposition decomposition_;
    LoadBalance load_balance_;
    Migration migration_;
    CellSort sort_;
    Halo halo_, solid_halo_;
    CellList cells_, solid_cells_;
    Neighbourhood neighbours_;
    ForceOptions explicit_forces_; // without the viscosity when that is implicit
    std::optional<ImplicitViscosity> viscosity_;
    std::optional<SurfaceTension> surface_tension_;
    std::optional<Inflow> inflow_;
    flow::Outlets outlets_;
    Bodies bodies_;
    StepPressure pressure_;
    PhaseTimers timers_;
    double before_ = 0; // [s] the last step, 0 before the first one
    flow::EndMotion end_motion_;
};

} // namespace treacle::sph
