#pragma once
#include "flow/inflow.hpp"
#include "flow/outlets.hpp"
#include "mpi/decomposition.hpp"
#include "sph/model/domain.hpp"
#include "sph/model/neighbourhood.hpp"

#include <vector>

namespace treacle::sph {

// Layers behind the opening whose particles move as prescribed: with the spacing between layers more than a
// support radius, so that what has passed it has all its neighbours.
int buffer_layers(const Constants& constants);

flow::Layers layers_of(const Constants& constants); // one particle spacing apart

// (Q) Liquid that flows in. Behind an opening lie layers of the lattice, a spacing apart, that move at its speed
// whatever acts on them; a particle that has passed it is free. Where a layer is follows from the time alone,
// ids from its number and the place in it: the same on any number of ranks. Each rank makes the particles of
// its own cells.
class Inflow {
public:
    // Declares the field of buffer particles.
    Inflow(
        const flow::InflowSetup& setup, const Constants& constants, const DomainBox& domain, LiquidParticles& liquid);

    // Puts in the layers that are due at the present time, those of this rank's cells. Ghosts are dropped.
    void emit(LiquidParticles& liquid, const Decomposition& decomposition);
    // Held particles get their velocity back, whatever has acted on them; ghosts' are left stale.
    void prescribe(LiquidParticles& liquid) const;
    // After predict(): buffer particles are unknowns of the pressure without a source, by which the pressure
    // goes on behind the opening as it is before it.
    void close(LiquidParticles& liquid) const;
    // After a step of dt [s]: what has passed its opening is free.
    void pass(LiquidParticles& liquid, double dt);

    std::int64_t emitted() const; // over all ranks, since the start
    double max_speed() const;     // of the inlets, now or later [m/s]

    // Time [s], then the layers made of each inlet, the same on all ranks. std::out_of_range where one is missing.
    std::vector<double> state() const;
    void restore(const std::vector<double>& state);

private:
    flow::InletEmitter source_;
    DomainBox domain_;
    std::vector<std::int64_t> made_;                 // layers of each inlet so far
    Array<double> prescribed_{"treacle::inlets", 0}; // [inlets][9] velocity, centre, direction
    double time_ = 0;                                // [s]
};

// Takes out the particles of this rank in outlets or beyond open sides of the domain, and returns how many.
int remove_outflow(const DomainBox& domain, const flow::Outlets& outlets, LiquidParticles& liquid);

// Rows of buffer particles become 0: what must not act on them.
void clear_prescribed(const LiquidParticles& liquid, const Array3& rows);

} // namespace treacle::sph
