#pragma once
#include "grid/geometry/fractions.hpp"
#include "grid/mac/particles.hpp"
#include "kokkos/cells.hpp"
#include "mpi/cell_halo.hpp"

namespace treacle::grid {

// Rate at which the density returns to that of rest.
struct DensityRelaxationOptions {
    double steps = 15;       // in which the density is that of rest again; 0: never. Short steps count for less
    double dead_band = 0.05; // share of the rest density that may be missing, or too much
};

// Liquid that has become sparse draws together. What is torn, splashes, or is poured in jets thinner than the cells comes to
// lie with its particles farther apart than the lattice's; velocities without divergence would keep it so, and its volume
// too large; and if liquid only drew together, what flows for long would be pressed together by the dead band of the position
// correction. Within the liquid the projections aim at a divergence of -(deficit - dead_band)/(steps dt) in its place, or of
// (surplus - dead_band)/(steps dt): the share of particles missing or too much, as a mean over a cell and those around it.
// Steps shorter than the time of a strain of 1/8 and of a fall through 1/32 of a cell, the lesser of both, count for their share of it, so
// that the motion is one of time and not of the number of steps. In it distances between particles change little.
class DensityRelaxation {
public:
    // Input of find(); arrays are over the window of the halo.
    struct Scene {
        const MacGrid& grid;
        const CellHalo& halo;
        const CellList& cells; // with ghosts in the cells around the owned ones
        const GridParticles& particles;
        const Array<double>& distance; // of centres from the surface [m], current two cells around the owned ones
        const Fractions& fractions;    // cell_fluid, current one cell around
        double gravity;                // [m/s2]
    };
    // Local. Cells beside the surface count for nothing, and cut ones have no divergence of their own. Since particles do not fill
    // cells that solids cut, the density beside these is taken without and with them, by the room that is left; what is less of
    // both acts, if they agree in the sign: seeding puts beside such cells what has no place in them.
    void find(const DensityRelaxationOptions& options, const Scene& scene, double dt);

    // [window] of the halo: what must flow into each owned cell, over the area of a face: -dx times the divergence [m/s].
    const Array<double>& inflow() const { return inflow_; }
    std::size_t bytes() const { return 8 * inflow_.span() + 4 * within_.span(); }

private:
    Array<int> within_{"treacle::within_liquid", 0}; // [window] number of particles, below 0: does not count
    Array<double> inflow_{"treacle::density_relaxation", 0};
};

} // namespace treacle::grid
