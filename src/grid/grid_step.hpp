#pragma once
#include "base/liquid_totals.hpp"
#include "base/timers.hpp"
#include "flow/inflow.hpp"
#include "flow/outlets.hpp"
#include "grid/geometry/closed_centres.hpp"
#include "grid/geometry/level_set.hpp"
#include "grid/momentum/momentum_balance.hpp"
#include "grid/options.hpp"
#include "grid/pressure/closing.hpp"
#include "grid/pressure/pressure.hpp"
#include "grid/pressure/resting_solids.hpp"
#include "grid/pressure/separation.hpp"
#include "grid/pressure/wall_pressures.hpp"
#include "grid/rheology/rheology.hpp"
#include "grid/surface_tension/curvature.hpp"
#include "grid/surface_tension/tension.hpp"
#include "grid/transport/face_fields.hpp"
#include "grid/transport/synchronise.hpp"
#include "grid/unified/stokes.hpp"
#include "grid/viscosity/slip_geometry.hpp"
#include "grid/viscosity/step_strains.hpp"
#include "grid/viscosity/viscosity.hpp"
#include "grid/viscosity/wall_momentum.hpp"
#include "mpi/halo.hpp"
#include "mpi/load_balance.hpp"
#include "mpi/migration.hpp"

#include <array>
#include <span>
#include <vector>

namespace treacle::grid {

// Constants of a run.
struct GridSetup {
    GridOptions options;
    scene::Domain domain;
    double density = 1000; // [kg/m3] of all liquids
    int liquids = 1;
    std::vector<double> surface_tension;        // [liquids] against air [N/m]; none: no liquid has any
    double viscosity = 0;                       // [Pa s] of all liquid, unless it varies; 0: without a viscous solve
    bool viscosity_varies = false;              // then each particle has its own
    std::vector<flow::ViscosityModel> rheology; // [liquids]; empty: no viscosity depends on the shear rate
    rigid::BodiesSetup rigid;                   // all bodies, those at rest as well
    SlipSetup slip;                             // of all of them
    flow::InflowSetup inflow;                   // the plugs of its inlets are among the bodies (inflow.hpp)
};

// Results of one step.
struct StepReport {
    double dt = 0;           // [s]
    PressureReport pressure; // of the first projection; iterations of both
    ViscosityReport viscosity;
    StokesReport stokes;               // of both together
    PositionReport correction;         // of the last step that had one
    std::vector<double> loads;         // [body][6] by pressure, mean of the step [N], [N m]
    std::vector<double> viscous_loads; // by viscosity; both of bodies that move
    // The same of solids at rest, torques about the origin: the six sides of the domain, then all bodies, 0 where they move.
    std::vector<double> resting_loads, resting_viscous_loads;
    std::int64_t projected_out = 0;                        // particles moved out of solids, over all ranks
    double imbalance = 1;                                  // largest over mean number of particles per rank
    std::vector<LostParticle> lost;                        // of this rank, but for what flowed out
    std::array<std::int64_t, loss_causes> lost_by_cause{}; // over all ranks
};

// The MAC/APIC solver (dissertation, chapter 5), collective over the decomposition's ranks.
class GridStep {
public:
    GridStep(const Comm& comm, const GridSetup& setup);

    // State of the run on this rank: particles, owned ones before ghosts; constants; decomposition; phase times [s].
    GridParticles& particles() { return particles_; }
    const GridParticles& particles() const { return particles_; }
    const GridSetup& setup() const { return setup_; }
    const MacGrid& grid() const { return grid_; }
    const rigid::RigidBodies& bodies() const { return bodies_; }
    const Comm& comm() const { return comm_; }
    const Decomposition& decomposition() const { return decomposition_; }
    PhaseTimers& timers() { return timers_; }
    const PhaseTimers& timers() const { return timers_; }

    // Collective: to be called when particles have been put into the store, on whatever rank.
    void start();
    // As start, with the decomposition of a checkpoint of the same number of ranks.
    void restore(std::span<const std::int64_t> state);
    // The bodies as a checkpoint has them; before start() or restore().
    void restore_bodies(std::span<const double> state) { bodies_.restore(state); }
    // State that the next step needs of those before it, whatever the number of ranks; restored before start() or
    // restore().
    std::vector<double> history() const;
    void restore_history(std::span<const double> state);
    std::vector<std::int64_t> decomposition_state() const;

    // One step of dt [s]. Throws SimulationError, on every rank, when a solve fails.
    StepReport advance(double dt);

    // Collective: particles at their owners, in order, after some were lost: for output.
    void refresh() { distribute_particles(); }

    // Collective. Largest step in which neither liquid nor bodies move farther than `cfl` widths, by their speed and what
    // gravity adds to it, and the limits of surface waves and surface tension [s]. Down to one width where liquid has been heaped up to more
    // than twice its density: parts of it that meet, or a wall, overlap by as much as they move in a step.
    double stable_step(double cfl) const;

    // Particles that have flowed in since the start of the run, over all ranks.
    std::int64_t emitted() const { return flow::particles_until(source_.setup(), source_.layers(), bodies_.time()); }

    // Collective: sums over the particles.
    LiquidTotals totals() const;

    // Results of the last step, for measurements; arrays over the window of halo().
    CellHalo& halo() { return cells_halo_; }
    const Fractions& fractions() const { return fractions_; }
    const FaceField& velocity() const { return velocity_; }
    const Array<double>& distance() const { return distance_; } // [m] of centres from the liquid's surface
    const Pressure& pressure() const { return pressure_; }

    // Bytes that this rank's particles, arrays and matrices take.
    std::size_t bytes() const;

    // Parts of advance(); not private, since nvcc takes no kernel in a private function.
    void sample_level_set_at_centres();
    void find_strains(double dt);
    void find_inflow(const FaceField& open);
    double largest_viscosity() const;
    double fastest(const Array3& of) const;
    std::array<double, 3> sum_of(const Array3& of) const;
    double least(const Array<double>& of) const;

private:
    void repartition();
    void rebalance();
    void distribute_particles();
    void connect(const CellBox& occupied);
    void particles_to_grid();
    void update_geometry();
    bool relaxes_density() const { return setup_.options.density_relaxation.steps > 0; }
    void project(StepReport& report, double dt, Pressure::SurfaceTension surface);
    bool gaps_change(bool first);
    void keep_start(const StepReport& report);
    void go_back(StepReport& report);
    void project_first(StepReport& report, double dt);
    bool separates();
    void close_gaps(StepReport& report, double dt);
    void apply_viscosity(StepReport& report, double dt);
    void split(StepReport& report, double dt);
    void together(StepReport& report, double dt);
    ViscousScene viscous_scene();
    PressureContext pressure_context();
    SlipAreas slip_areas() const;
    bool solves_monolithic(double dt) const;
    bool viscous() const { return setup_.viscosity_varies || setup_.viscosity > 0 || rheology_.any(); }
    void find_viscosities_by_rate();
    void find_viscosities();
    DiffusionNumber viscous_spread(double dt) const { return {viscosities_.cell, setup_.density, dt}; }
    void extrapolate_velocity(const WallCondition& condition);
    void show_pressures();
    void load_resting(StepReport& report, double dt, bool at_once);
    void leave_solids(double dt);
    WallMomentum::Scene wall_scene();
    void follow_walls() { wall_momentum_.begin(grid_, cells_halo_.window(), velocity_); }
    const RestingSolids& no_slip() const { return slip_.any() ? no_slip_ : resting_; }
    void move(StepReport& report, StepTimes& times);
    MomentumBalance::Scene balance_scene();
    bool balances() const { return bodies_.any_moves() && setup_.options.coupling == Coupling::strong; }
    void balance_momentum(StepReport& report, double kick);
    double pull() const;
    double wave_step() const;
    std::array<double, 9> sums(const Array3& velocity) const;
    EndMotion::Middle middle_motion() const;
    void correct(StepReport& report);
    void collect(StepReport& report);

    Comm comm_;
    GridSetup setup_;
    MacGrid grid_;
    GridParticles particles_;
    Array<double> particle_mass_{"treacle::particle_mass", 0}; // [liquids]
    rigid::RigidBodies bodies_;
    Decomposition decomposition_;
    LoadBalance load_balance_;
    Migration migration_;
    CellSort sort_;
    Halo halo_;
    CellList cells_;
    CellHalo cells_halo_;
    flow::InletEmitter source_;
    flow::Outlets outlets_;
    BodyStepRecord body_steps_;
    Solids solids_;
    LevelSet level_set_;
    FractionBuilder fraction_builder_;
    Fractions fractions_;
    FaceBodyFractions body_fractions_;
    SlipGeometry slip_;
    ClosedCentres closed_centres_;
    RestingSolids resting_, no_slip_; // all, and of them the no-slip ones
    PressureCoupling resting_pressures_;
    WallMomentum wall_momentum_;
    WallPressures wall_pressures_;
    Array<double> distance_{"treacle::centre_distance", 0};
    FaceField mass_, velocity_, start_, scratch_; // start: of the particles, before the step changes it
    FaceValidity known_, extrapolated_;
    Rheology rheology_;
    Viscosities viscosities_;
    SurfaceTensions tensions_;
    Curvature curvature_;
    Pressure pressure_;
    Viscosity viscosity_;
    Stokes stokes_;
    FaceField open_; // of faces that no solid takes along
    PositionCorrection correction_;
    DensityRelaxation density_relaxation_;
    StepStrains strains_;
    Separation separation_;
    Closing closing_;
    FaceField open_velocity_; // of keep_start(); bodies and loads likewise
    rigid::RigidBodies::Snapshot open_bodies_;
    std::vector<double> open_loads_, open_walls_;
    Array<double> inflow_{"treacle::inflow", 0}; // [window] what must flow into cells, of contraction and strains [m/s]
    PhaseTimers timers_;
    EndMotion end_motion_;
    MomentumBalance balance_;
    std::int64_t steps_ = 0;
    double before_ = 0, dt_ = 0;   // [s] length of the last step, 0: there was none; of this one
    double max_density_error_ = 0; // largest density error that the last position correction left
};

} // namespace treacle::grid
