#pragma once
#include "grid/mac/mac_grid.hpp"
#include "grid/mac/particles.hpp"
#include "mpi/cell_halo.hpp"

namespace treacle::grid {

// Curvatures of the liquid's surface at the centres of cells, from how much liquid each holds (src/grid/theory.md, Surface tension).
class Curvature {
public:
    // Input of find() by particles.
    struct Scene {
        const MacGrid& grid;
        CellHalo& halo;
        const GridParticles& particles;
        const CellList& cells;
        const Array<double>& particle_mass; // [liquids] [kg]
        double density;                     // [kg/m3]
        const Fractions& fractions;         // cell_liquid, cell_liquid_clipped
    };
    // Collective. Of the particles' volumes, spread by linear weights, and of the liquid as it is continued into solids. The
    // ghosts' positions and liquids must be those of their owners.
    void find(const Scene& scene);
    // Collective. Of volume fractions of liquid that are given in the owned cells [window]; they are overwritten.
    void find(const MacGrid& grid, CellHalo& halo, Array<double>& fraction);

    // [window] [1/m] of the surface nearest to each centre within a few cells of it, > 0 of drops; of the owned cells and one
    // cell around them.
    const Array<double>& at_centres() const { return curvature_; }
    std::size_t bytes() const {
        return 8 * (fraction_.span() + twice_.span() + scratch_.span() + curvature_.span() + curvature_twice_.span());
    }

private:
    Array<double> fraction_{"treacle::liquid_fraction", 0}, twice_{"treacle::smoother_fraction", 0},
        scratch_{"treacle::smooth_scratch", 0}, curvature_{"treacle::curvature", 0},
        curvature_twice_{"treacle::curvature_of_smoother", 0};
};

} // namespace treacle::grid
