#pragma once
#include "mpi/halo.hpp"
#include "sph/model/neighbourhood.hpp"

namespace treacle::sph {

// Data of a step that its parts read and write. Positions of ghosts must be current, and the neighbours those of the
// positions.
struct StepContext {
    const SphOptions& options;
    const Constants& constants;
    const Comm& comm;
    LiquidParticles& liquid;
    const SolidParticles& solid;
    const Neighbourhood& neighbours;
    Halo& halo;
    const CellList& cells; // of the liquid
    bool driven = false;   // solids that move, or inlets, push the liquid; the same on all ranks
};

} // namespace treacle::sph
