#pragma once
#include "grid/mac/mac_grid.hpp"
#include "grid/mac/particles.hpp"
#include "mpi/cell_halo.hpp"

#include <vector>

namespace treacle::grid {

// Surface tensions against air of several liquids; between liquids there is none.
class SurfaceTensions {
public:
    // [liquids] [N/m]; none: none of them has one.
    explicit SurfaceTensions(std::vector<double> of_liquids);

    bool differ() const { return differ_; }     // two liquids have unlike ones
    double largest() const { return largest_; } // [N/m]

    // Collective, where they differ. At the centre of each cell the mean over the particles around, by mass, and where there
    // are none over those around the cells beside. The ghosts' liquid must have been gathered.
    void find(const MacGrid& grid, CellHalo& halo, const GridParticles& particles, const CellList& cells,
        const Array<double>& particle_mass);
    const Array<double>& at_centres() const { return tension_; } // [window] [N/m]

    // Memory of this rank [bytes].
    std::size_t bytes() const { return 8 * (mass_.span() + weighted_sum_.span() + scratch_.span() + tension_.span()); }

private:
    std::vector<double> of_liquids_;
    bool differ_ = false;
    double largest_ = 0;
    Array<double> weighted_mass_{"treacle::tension_by_mass", 0}; // [liquids]
    Array<double> mass_{"treacle::tension_mass", 0}, weighted_sum_{"treacle::tension_weighted_sum", 0},
        scratch_{"treacle::tension_scratch", 0};
    Array<double> tension_{"treacle::tensions", 0};
};

} // namespace treacle::grid
