#pragma once
#include "kokkos/particle_store.hpp"

namespace treacle {

// For each owned particle of a store, the particles of a store (the same or another) closer than a radius,
// in the order of their cells and ids, itself left out. Compressed rows: neighbours of i are
// index(offset(i)) ... index(offset(i + 1) - 1), row numbers of the other store, ghosts included.
// Built by a count pass and a fill pass.
class NeighbourList {
public:
    Array<std::int64_t> offset{"treacle::neighbour_offset", 0}; // [owned + 1]
    Array<int> index{"treacle::neighbour_index", 0};
    std::int64_t size = 0;

    void build(const ParticleStore& of, const ParticleStore& among, const CellGrid& grid,
               const CellList& cells, double radius);
    std::size_t bytes() const { return offset.span() * 8 + index.span() * 4 + 3 * along_[0].span() * 8; }

private:
    Array<double> along_[3] = {Array<double>("treacle::along_x", 0), Array<double>("treacle::along_y", 0),
                               Array<double>("treacle::along_z", 0)};
};

} // namespace treacle
