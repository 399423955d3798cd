#pragma once
#include "grid/geometry/pores.hpp"
#include "grid/geometry/solids.hpp"
#include "grid/mac/particles.hpp"

namespace treacle::grid {

// The liquid's surface from its particles, at the fine nodes of a window [m], negative in the liquid (Zhu and Bridson
// 2005): the distance |x - mean(x_p)| to the weighted mean of the particles within `reach` = dx, mapped such that it is
// the distance to the surface where the liquid is a half space. A particle by itself is a ball of radius 0.246 dx, about
// half the particles' spacing. Particles near solids have images in them, so that liquid goes on through a solid's
// surface; deeper in solids it is continued along their normals.
class LevelSet {
public:
    // Collective. The ghosts' positions must be those of the owners. Writes the particles' field `image`.
    void build(const MacGrid& grid, CellHalo& halo, const GridParticles& particles, const CellList& cells,
        const Solids& solids);

    const Array<double>& distance() const { return distance_; } // [fine nodes of the window]
    std::size_t surface_cells() const { return surface_; }      // whose nodes were summed over particles

private:
    void continue_into_solids(const FineNodes& nodes, const Array<double>& solid);

    Array<double> distance_{"treacle::liquid_distance", 0};
    Array<double> half_space_{
        "treacle::half_space_map", 0}; // of the mean's distance: where the surface is, both over reach
    Array<double> along_[3] = {Array<double>("treacle::level_set_x", 0), Array<double>("treacle::level_set_y", 0),
        Array<double>("treacle::level_set_z", 0)}; // positions of all particles, axis by axis
    Array<int> layer_{"treacle::continuation_layer", 0}, in_solids_{"treacle::nodes_in_solids", 0};
    Pores pores_;
    int dimensions_ = 0; // that half_space_ is of
    std::size_t surface_ = 0;
};

} // namespace treacle::grid
