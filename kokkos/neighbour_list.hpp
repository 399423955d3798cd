#pragma once
#include "kokkos/particle_store.hpp"

namespace treacle {

// For each owned particle of a store, the particles of a store (the same or another) closer than a radius,
// in the order of their cells and ids, itself left out. Compressed rows: neighbours of i are
// index(offset(i)) ... index(offset(i + 1) - 1), row numbers of the other store, ghosts included.
// Candidates are tested once; a bit for each of them is stored until the rows are laid out.
class NeighbourList {
public:
    Array<std::int64_t> offset{"treacle::neighbour_offset", 0}; // [owned + 1]
    Array<int> index{"treacle::neighbour_index", 0};            // [size + 16], rows of the other store
    std::int64_t size = 0;
    // Entries behind the last row, all 0: whoever reads a row several entries at a time may read beyond its end.
    static constexpr int padding = 16;

    // Neighbours of the owned particles of `of` among all particles of `among`, which `cells` lists. The radius [m] is
    // at most a cell's width. A distance of 0 counts, but from a particle to itself.
    void build(const ParticleStore& of, const ParticleStore& among, const CellGrid& grid, const CellList& cells,
        double radius);
    // Memory of the list and of what building it needs [B].
    std::size_t bytes() const {
        return offset.span() * 8 + index.span() * 4 + 3 * along_[0].span() * 8 + masks_.span() * 2 +
               mask_offset_.span() * 8;
    }

private:
    Array<double> along_[3] = {Array<double>("treacle::along_x", 0), Array<double>("treacle::along_y", 0),
        Array<double>("treacle::along_z", 0)};
    Array<std::uint16_t> masks_{"treacle::neighbour_masks", 0};
    Array<std::int64_t> mask_offset_{"treacle::neighbour_mask_offset", 0}; // per chunk of particles
};

} // namespace treacle
