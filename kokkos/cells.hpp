#pragma once
#include "kokkos/types.hpp"

namespace treacle {

// a / b rounded down, b > 0.
KOKKOS_INLINE_FUNCTION constexpr int floor_divide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

// An axis-aligned block of cells, half open: lo <= c < hi.
struct CellBox {
    int lo[3] = {0, 0, 0};
    int hi[3] = {0, 0, 0};

    KOKKOS_INLINE_FUNCTION bool empty() const { // no cell: an axis without extent
        return lo[0] >= hi[0] || lo[1] >= hi[1] || lo[2] >= hi[2];
    }
    // Same as lo <= c < hi on all axes.
    KOKKOS_INLINE_FUNCTION bool contains(const int c[3]) const {
        return c[0] >= lo[0] && c[0] < hi[0] && c[1] >= lo[1] && c[1] < hi[1] && c[2] >= lo[2] && c[2] < hi[2];
    }
    // Number of cells.
    KOKKOS_INLINE_FUNCTION std::int64_t size() const {
        return empty() ? 0 : std::int64_t(hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]);
    }
    // Position in the block, x fastest; the cell must lie in it.
    KOKKOS_INLINE_FUNCTION int index(int x, int y, int z) const {
        return (x - lo[0]) + (hi[0] - lo[0]) * ((y - lo[1]) + (hi[1] - lo[1]) * (z - lo[2]));
    }
    KOKKOS_INLINE_FUNCTION void cell(int index, int c[3]) const {
        const int nx = hi[0] - lo[0], ny = hi[1] - lo[1];
        c[0] = lo[0] + index % nx;
        c[1] = lo[1] + index / nx % ny;
        c[2] = lo[2] + index / (nx * ny);
    }
};

// Cells of both; may be empty with hi < lo.
inline CellBox intersect(const CellBox& a, const CellBox& b) {
    CellBox out;
    for (int k = 0; k < 3; ++k) {
        out.lo[k] = math::max(a.lo[k], b.lo[k]);
        out.hi[k] = math::min(a.hi[k], b.hi[k]);
    }
    return out;
}

// With `layers` more cells on either side of each axis; 2D scenes have no third one.
inline CellBox grown(const CellBox& box, int layers, int dimensions) {
    CellBox out = box;
    for (int k = 0; k < dimensions; ++k) {
        out.lo[k] -= layers;
        out.hi[k] += layers;
    }
    return out;
}

// The smallest box around two; an empty one adds nothing.
inline CellBox join(const CellBox& a, const CellBox& b) {
    if (a.empty() || b.empty()) return a.empty() ? b : a;
    CellBox out;
    for (int k = 0; k < 3; ++k) {
        out.lo[k] = math::min(a.lo[k], b.lo[k]);
        out.hi[k] = math::max(a.hi[k], b.hi[k]);
    }
    return out;
}

// The uniform cells that cover the domain: the unit of ownership, of halos and of the neighbour search.
// A cell is at least one support radius wide, so that neighbours lie in adjacent cells. 2D scenes have one
// layer of cells in z.
struct CellGrid {
    double origin[3] = {0, 0, 0};        // [m], lower corner of cell (0, 0, 0)
    double inverse_width[3] = {1, 1, 1}; // [1/m]
    double period[3] = {0, 0, 0};        // [m], 0: not periodic
    int count[3] = {1, 1, 1};
    int dimensions = 3;

    // A position outside belongs to the nearest cell of the border: neighbours stay in adjacent cells.
    KOKKOS_INLINE_FUNCTION void locate(double x, double y, double z, int c[3]) const {
        const double p[3] = {x, y, z};
        for (int k = 0; k < 3; ++k) {
            c[k] = static_cast<int>(math::floor((p[k] - origin[k]) * inverse_width[k]));
            c[k] = math::min(math::max(c[k], 0), count[k] - 1);
        }
    }
    bool periodic(int axis) const { return period[axis] > 0; }
    CellBox all() const {
        CellBox box;
        for (int k = 0; k < 3; ++k) box.hi[k] = count[k];
        return box;
    }
    // Cells on either side that a particle's neighbours may lie in.
    KOKKOS_INLINE_FUNCTION int halo_width(int axis) const { return axis < dimensions ? 1 : 0; }
};

// Ranges of each cell of a window in the particles' arrays. Within a cell they are ordered by id, and a cell's
// particles are all owned or all ghosts.
struct CellList {
    CellBox window;   // owned cells and one layer of halo
    Array<int> begin; // [cells of window]
    Array<int> end;   // [cells of window], one past the last row
};

} // namespace treacle
