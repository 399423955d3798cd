#pragma once
#include "mpi/halo.hpp"
#include "sph/forces.hpp"

namespace treacle::sph {

// What a step has for the viscous solve. Positions of ghosts must be current, and the neighbours those of the
// positions.
struct ViscousScene {
    const SphOptions& options;
    const Constants& constants;
    const ForceOptions& forces;
    const Comm& comm;
    LiquidParticles& liquid;
    const SolidParticles& solid;
    const Neighbourhood& neighbours;
    Halo& halo;
    Halo* solid_halo = nullptr; // needed where solids slip
};

// And how its solids move.
struct ViscousParts : ViscousScene {
    const LoadPoints& points;
    const Array<double>& friction; // of each solid, see ViscousWalls
    const Array<double>& motion;
};

} // namespace treacle::sph
