#pragma once
#include "mpi/halo.hpp"
#include "sph/model/neighbourhood.hpp"

namespace treacle::sph {

// Solid particles as unknowns of the pressure system, after Koshizuka et al. 1996 and Shao & Lo 2003 (src/sph/theory.md).
class SolidRows {
public:
    // Around each owned solid particle.
    NeighbourList liquid, solid;

    // Roles of solid particles: unknowns where an unknown of the liquid is near, else p = 0. Writes their role and
    // diagonal, and to wall_term of the liquid's particles by how much solids hold them to p = 0, which anchoring
    // requires. Ghost liquid roles must be current; gathers the solids'. Returns this rank's number of unknown solids.
    // Collective.
    std::int64_t predict(const SphOptions& options, const Constants& constants, LiquidParticles& liquid_particles,
        SolidParticles& solid_particles, const Neighbourhood& neighbours, Halo& solid_halo) const;
    std::size_t bytes() const { return liquid.bytes() + solid.bytes(); }
};

} // namespace treacle::sph
