#pragma once
#include "app/setup/geometry.hpp"
#include "base/liquid_totals.hpp"
#include "base/losses.hpp"
#include "base/timers.hpp"
#include "kokkos/particle_store.hpp"
#include "rigid/bodies.hpp"

#include <memory>

namespace treacle::app {

// Figures of a step that every method gives.
struct StepDiagnostics {
    double dt = 0; // [s]
    int pressure_iterations = 0;
    std::vector<double> values;        // as Simulation::columns() names them
    std::vector<double> loads;         // [load_names()][6] by pressure, summed over ranks [N], [N m]
    std::vector<double> viscous_loads; // by viscosity
    std::vector<LostParticle> lost;    // of this rank, but for what flowed out
    std::array<std::int64_t, loss_causes> lost_by_cause{}; // over all ranks
    std::vector<std::string> warnings;                     // for the log
};

// The liquid's particles of this rank for measurements.
struct LiquidView {
    Array3 position, velocity; // [m], [m/s]
    Array<int> liquid;         // index of the scene's liquid [capacity]
    int owned = 0;
    double spacing = 0;        // [m]
    double support_radius = 0; // over which a particle's surroundings are sampled [m]
    double volume = 0;         // of a particle at rest [m3], [m2] in 2D
    Array<int> waiting;        // not 0 of liquid behind an inlet's opening; without rows where there is none
};

// State that a checkpoint holds besides the fields of the particle stores.
struct RestartState {
    std::vector<std::int64_t> decomposition; // empty: of another number of ranks
    std::vector<double> bodies;              // of rigid::RigidBodies::state(), the same on every rank
    std::vector<double> history;             // of the method, whatever the number of ranks
};

// A run's method, as the time loop drives it. All but the getters are collective.
class Simulation {
public:
    virtual ~Simulation() = default;
    virtual const Comm& comm() const = 0;

    // Puts the scene's particles in, each rank those of its own part, and starts. Returns notes for the user
    // about the scene: fallbacks, thin bodies, what is not modelled.
    virtual std::vector<std::string> fill(const Geometry& geometry) = 0;
    // Goes on from a checkpoint whose fields have been read into the stores.
    virtual void restore(const RestartState& state) = 0;
    virtual RestartState state() const = 0;

    // One step of dt [s]. Throws SimulationError on every rank.
    virtual StepDiagnostics advance(double dt) = 0;
    virtual double stable_step(double cfl) const = 0; // [s]
    // Brings what frames show up to date with the places of the particles.
    virtual void refresh() = 0;
    virtual LiquidTotals totals() const = 0;

    // Stores of this rank: liquid, and the particles of solids. References stay valid as long as the simulation.
    virtual ParticleStore& liquid() = 0;
    virtual const ParticleStore& liquid() const = 0;
    virtual ParticleStore* solid() = 0; // null where solids are no particles
    virtual const ParticleStore* solid() const = 0;
    // Points on solids where they are now, with their fields id and body, for frames.
    virtual const ParticleStore& solid_points() = 0;
    virtual LiquidView view() const = 0;
    virtual const rigid::RigidBodies& bodies() const = 0;
    virtual std::int64_t emitted() const = 0; // particles that flowed in since the start of the run, over all ranks
    virtual const PhaseTimers& timers() const = 0;
    virtual std::size_t bytes() const = 0; // that this rank's data take

    // Names of what carries loads, in the order of StepDiagnostics::loads.
    virtual std::vector<std::string> load_names() const = 0;
    // Names with units of the method's own figures of a step, and of the phases in the order in which a step goes
    // through them: columns of steps.csv.
    virtual std::vector<std::string> columns() const = 0;
    virtual std::vector<std::string> phases() const = 0;
};

// For the method of the scene, without particles. Collective. The reference speed is that of the artificial viscosity of
// method sph. Input and geometry must outlive what is returned; the geometry is needed where bodies move, or with method grid.
std::unique_ptr<Simulation> make_simulation(
    const Comm& comm, const Input& input, double reference_speed, const Geometry& geometry);

} // namespace treacle::app
