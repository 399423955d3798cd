#pragma once
#include "mpi/decomposition.hpp"
#include "sph/domain.hpp"
#include "sph/neighbourhood.hpp"

#include <array>
#include <vector>

namespace treacle::sph {

// An opening through which layers of the lattice flow in at one speed.
struct InletSetup {
    int liquid = 0;
    double viscosity = 0;     // of its particles, where particles have their own [Pa s]
    Vec3 centre{0, 0, 0};     // [m]
    Vec3 direction{0, 0, -1}; // unit
    std::vector<Vec3> points; // of one layer, from the centre, across the direction [m]
    double speed = 0;         // [m/s]
    double start = 0;         // [s] when the first layer passes the opening
    double end = 0;           // [s] when the last one does; 0: none is the last
};

// Where particles are taken out: a box, or what lies behind a plane.
struct OutletSetup {
    bool box = true;
    Vec3 min{0, 0, 0}, max{0, 0, 0};
    Vec3 point{0, 0, 0}, normal{0, 0, 1};
};

struct InflowSetup {
    std::vector<InletSetup> inlets;
    std::vector<OutletSetup> outlets;
    std::int64_t first_id = 0; // of what flows in; all others' are below
};

// Layers behind the opening whose particles move as prescribed: with the spacing between layers more than a
// support radius, so that what has passed it has all its neighbours.
int held_layers(const Constants& constants);

// Number of layers that an inlet has made up to a time [s], and in a run up to an end.
std::int64_t layers_until(const InletSetup& inlet, const Constants& constants, double time);

// Liquid that flows in. Behind an opening lie layers of the lattice, a spacing apart, that move at its speed
// whatever acts on them; a particle that has passed it is free. Where a layer is follows from the time alone,
// ids from its number and the place in it: the same on any number of ranks. Each rank makes the particles of
// its own cells.
class Inflow {
public:
    // Declares the field of held particles.
    Inflow(const InflowSetup& setup, const Constants& constants, const DomainBox& domain,
           LiquidParticles& liquid);

    // Puts in the layers that are due at the present time, those of this rank's cells. Ghosts are dropped.
    void emit(LiquidParticles& liquid, const Decomposition& decomposition);
    // Held particles get their velocity back, whatever has acted on them; ghosts' are left stale.
    void hold(LiquidParticles& liquid) const;
    // After predict(): held particles are unknowns of the pressure without a source, by which the pressure
    // goes on behind the opening as it is before it.
    void close(LiquidParticles& liquid) const;
    // After a step of dt [s]: what has passed its opening is free.
    void pass(LiquidParticles& liquid, double dt);

    std::int64_t emitted() const; // over all ranks, since the start
    double max_speed() const;     // of the inlets, now or later [m/s]

    std::vector<double> state() const;
    void restore(const std::vector<double>& state);

private:
    struct Opening {
        InletSetup setup;
        Array3 points;
        std::int64_t layers = 0; // made so far
    };
    double place_of(const InletSetup& inlet, std::int64_t layer) const;
    std::int64_t id_of(std::size_t inlet, std::int64_t layer) const;

    InflowSetup setup_;
    Constants constants_;
    DomainBox domain_;
    std::vector<Opening> openings_;
    Array<double> prescribed_{"treacle::inlets", 0}; // [inlets][9] velocity, centre, direction
    double time_ = 0;                                // [s]
};

// Takes out the particles of this rank in outlets or beyond open sides of the domain, and returns how many;
// the outlets from upload_outlets.
int remove_outflow(const DomainBox& domain, const Array<double>& outlets, LiquidParticles& liquid);
Array<double> upload_outlets(const std::vector<OutletSetup>& outlets);

// Rows of held particles become 0: what must not act on them.
void clear_held(const LiquidParticles& liquid, const Array3& rows);

} // namespace treacle::sph
