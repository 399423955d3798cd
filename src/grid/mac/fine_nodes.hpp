#pragma once
#include "grid/mac/mac_grid.hpp"

namespace treacle::grid {

// True for boxes with the same corners.
inline bool same_cells(const CellBox& a, const CellBox& b) {
    bool same = true;
    for (int k = 0; k < 3; ++k) same = same && a.lo[k] == b.lo[k] && a.hi[k] == b.hi[k];
    return same;
}

// Nodes of the double-resolution grid of a window: corners of cubes of width dx/2, eight to a cell, those of a cell
// together, so that a halo of cells carries them as blocks of `per_cell` numbers. Node (x, y, z) lies at
// lower + dx/2 (x, y, z); node 2c is the lower corner of cell c. 2D scenes use z = 0 alone.
struct FineNodes {
    static constexpr int per_cell = 8;
    CellBox window;    // of cells
    double lower[3]{}; // [m]
    double width = 0;  // dx / 2 [m]
    int dimensions = 3;

    FineNodes() = default;
    // Nodes of the cells `cells` of the grid.
    FineNodes(const MacGrid& grid, const CellBox& cells)
        : window(cells), lower{grid.lower[0], grid.lower[1], grid.lower[2]}, width(0.5 * grid.dx),
          dimensions(grid.dimensions) {}

    // Number of nodes, and place of the node (x, y, z), which must lie in the window.
    std::size_t size() const { return static_cast<std::size_t>(per_cell * window.size()); }
    KOKKOS_INLINE_FUNCTION int index(int x, int y, int z) const {
        return per_cell * window.index(x >> 1, y >> 1, z >> 1) + (x & 1) + 2 * (y & 1) + 4 * (z & 1);
    }
    // Position of corner `corner` of cell c [m].
    KOKKOS_INLINE_FUNCTION void position(const int c[3], int corner, double x[3]) const {
        for (int k = 0; k < 3; ++k) x[k] = lower[k] + width * (2 * c[k] + (corner >> k & 1));
        if (dimensions == 2) x[2] = 0;
    }
    // Nearer than this to a solid's surface [m] a node lies in it but for round-off, whose sign differs with the ranks.
    // Nodes do lie there: on walls, and on bodies after a fall of cfl dx.
    KOKKOS_INLINE_FUNCTION double surface() const { return 1e-9 * width; }
    // True for a node in a solid, by its distance from the solids [m]; nodes in the surface are outside.
    KOKKOS_INLINE_FUNCTION bool is_inside(double solid) const { return solid <= -surface(); }
    KOKKOS_INLINE_FUNCTION int used() const { return dimensions == 2 ? 4 : 8; } // corners of a cell that count
    // The node in the middle of the face across `axis` below cell c, which must lie in the window.
    KOKKOS_INLINE_FUNCTION int face_middle(int axis, const int c[3]) const {
        return per_cell * static_cast<int>(window.index(c[0], c[1], c[2])) + ((used() - 1) & ~(1 << axis));
    }
};

// A distance given at fine nodes, anywhere in the window: trilinear between them; what lies outside of the window
// takes the value at its border.
struct DistanceSampler {
    FineNodes nodes;
    Array<double> values; // [nodes.size()] [m]

    // The node nearest to x.
    KOKKOS_INLINE_FUNCTION int nearest(const double x[3]) const {
        int f[3] = {0, 0, 0};
        for (int k = 0; k < nodes.dimensions; ++k) {
            f[k] = static_cast<int>(math::floor((x[k] - nodes.lower[k]) / nodes.width + 0.5));
            f[k] = math::min(math::max(f[k], 2 * nodes.window.lo[k]), 2 * nodes.window.hi[k] - 1);
        }
        return nodes.index(f[0], f[1], f[2]);
    }
    // Value [m].
    KOKKOS_INLINE_FUNCTION double at(const double x[3]) const {
        int base[3] = {0, 0, 0};
        double s[3] = {0, 0, 0};
        for (int k = 0; k < nodes.dimensions; ++k) {
            const int first = 2 * nodes.window.lo[k], last = 2 * nodes.window.hi[k] - 1;
            double p = (x[k] - nodes.lower[k]) / nodes.width;
            // In this order what is not a number goes to the border.
            p = math::min(double(last), math::max(double(first), p));
            base[k] = math::min(static_cast<int>(math::floor(p)), last - 1);
            s[k] = p - base[k];
        }
        const int up = nodes.dimensions == 2 ? 0 : 1;
        double plane[2]; // values after interpolation along x and y
        for (int z = 0; z <= up; ++z) {
            double line[2];
            for (int y = 0; y < 2; ++y) {
                const double a = values(nodes.index(base[0], base[1] + y, base[2] + z));
                const double b = values(nodes.index(base[0] + 1, base[1] + y, base[2] + z));
                line[y] = a + s[0] * (b - a);
            }
            plane[z] = line[0] + s[1] * (line[1] - line[0]);
        }
        return up ? plane[0] + s[2] * (plane[1] - plane[0]) : plane[0];
    }
    // Gradient, of second order and continuous: differences over the width of the nodes, centred on x. (That of the interpolant jumps at the
    // nodes, where it turns the normal of a round surface by width / 2 R: a body that turns along its surface would then move across it.)
    KOKKOS_INLINE_FUNCTION void gradient(const double x[3], double out[3]) const {
        for (int k = 0; k < 3; ++k) {
            out[k] = 0;
            if (k >= nodes.dimensions) continue;
            double below[3] = {x[0], x[1], x[2]}, above[3] = {x[0], x[1], x[2]};
            below[k] -= 0.5 * nodes.width;
            above[k] += 0.5 * nodes.width;
            out[k] = (at(above) - at(below)) / nodes.width;
        }
    }
    // Second derivatives [1/m], over a cell's width; of a distance they are how its normal turns.
    KOKKOS_INLINE_FUNCTION void second_derivatives(const double x[3], double out[3][3]) const {
        for (int l = 0; l < 3; ++l) {
            double below[3] = {x[0], x[1], x[2]}, above[3] = {x[0], x[1], x[2]}, low[3] = {0, 0, 0},
                   high[3] = {0, 0, 0};
            below[l] -= nodes.width;
            above[l] += nodes.width;
            if (l < nodes.dimensions) {
                gradient(below, low);
                gradient(above, high);
            }
            for (int k = 0; k < 3; ++k) out[k][l] = (high[k] - low[k]) / (2 * nodes.width);
        }
    }
};

} // namespace treacle::grid
