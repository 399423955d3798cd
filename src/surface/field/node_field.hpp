#pragma once
#include "surface/field/lattice.hpp"

namespace treacle::surface {

// Values of the implicit function in units of the particles' spacing, positive in the liquid; `far` where nothing is near.
inline constexpr double far = 8;

enum TileState : int { tile_empty = -1, tile_full = -2 }; // else the tile's slot

// A function on the lattice's nodes: values in the tiles near the surface, `far` in the tiles deep in the liquid, -far
// elsewhere. Node numbers are those from the grid's first tile.
struct NodeField {
    CellBox window;      // tiles
    Array<int> state;    // [tiles of window] slot, or TileState
    Array<double> value; // [slots][nodes of a tile]
    int dimensions = 3;

    // Tile of a node along one axis, and the slot or TileState of its tile; outside of the window: empty.
    KOKKOS_INLINE_FUNCTION static int tile(int node) { return node >> 3; }
    KOKKOS_INLINE_FUNCTION int slot(const int node[3]) const {
        const int c[3] = {tile(node[0]), tile(node[1]), dimensions == 3 ? tile(node[2]) : 0};
        return window.contains(c) ? state(window.index(c[0], c[1], c[2])) : int(tile_empty);
    }
    // Place of a node in its tile.
    KOKKOS_INLINE_FUNCTION int local(const int node[3]) const {
        const int z = dimensions == 3 ? node[2] & 7 : 0;
        return (z * tile_edge + (node[1] & 7)) * tile_edge + (node[0] & 7);
    }
    KOKKOS_INLINE_FUNCTION int nodes() const { return dimensions == 3 ? 512 : 64; }
    KOKKOS_INLINE_FUNCTION double at(const int node[3]) const {
        const int s = slot(node);
        if (s < 0) return s == tile_full ? far : -far;
        return value(std::int64_t(s) * nodes() + local(node));
    }
};

// Cubic B-spline with its knots at whole numbers, 0 beyond 2; its integral is 1.
KOKKOS_INLINE_FUNCTION double cubic_spline(double s) {
    const double q = math::fabs(s);
    const double outer = math::max(0.0, 2 - q), inner = math::max(0.0, 1 - q);
    return (outer * outer * outer - 4 * (inner * inner * inner)) * (1.0 / 6);
}

} // namespace treacle::surface
