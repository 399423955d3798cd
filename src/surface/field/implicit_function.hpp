#pragma once
#include "surface/field/points.hpp"
#include "surface/field/solids.hpp"
#include "surface/field/tile_halo.hpp"

namespace treacle::surface {

// (SF2), (SF3), (SF4) The implicit function from the points. Equations: src/surface/README.md.
class ImplicitFunction {
public:
    // Collective. `box`: this rank's tiles. With `solids` the function is cut at their surfaces.
    void build(const Decomposition& decomposition, const Lattice& lattice, const Points& points, const Options& options,
        const Solids* solids);

    const NodeField& field() const { return field_; }  // of the last build()
    int slots() const { return slots_; }               // tiles of the window that have values
    const Array<int>& tiles() const { return tiles_; } // [slots] index of the tile in the window
    // [slots][nodes] 1: the solid's distance stands there
    const Array<double>& at_solid() const { return at_solid_; }

    // Kernels (public for nvcc).
    void classify(const Lattice& lattice, const CellBox& box, const Points& points, double support);
    void settle_liquids(const CellBox& box, const Points& points, double support, int liquid);
    void separate(const Lattice& lattice, const Points& points, const Options& options);
    void sum_splines(const Lattice& lattice, const Points& points, const Options& options);
    void deconvolve(const Lattice& lattice, const Options& options);
    void shift(const Lattice& lattice, double iso);
    void close_borders(const Lattice& lattice);

private:
    void settle_near_solids(const Lattice& lattice, const CellBox& box, const Solids& solids, double spacing);
    void cut_at_solids(const Lattice& lattice, const Solids& solids, double spacing);

    NodeField field_;
    TileHalo halo_;
    int slots_ = 0, own_ = 0;
    std::vector<int> codes_;
    Array<int> code_{"treacle::tile_codes", 0}, tiles_{"treacle::slot_tiles", 0}, own_slots_{"treacle::own_slots", 0};
    Array<double> at_solid_{"treacle::nodes_at_solids", 0};
    Array<double> fraction_{"treacle::smoothed_fraction", 0}; // u of the slots
    Array<double> next_{"treacle::next_values", 0};
};

} // namespace treacle::surface
