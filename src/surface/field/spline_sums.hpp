#pragma once
#include "surface/field/node_field.hpp"
#include "surface/field/points.hpp"

namespace treacle::surface {

// (SF1) Sums of products of cubic B-splines along the axes over the points around a tile, at its nodes.
struct SplineSums {
    double to_h[3] = {0, 0, 0};           // lattice steps in widths of the spline
    double support_radius[3] = {0, 0, 0}; // of a point, in lattice steps
    int dimensions = 3;

    // `width` h of the spline [m]; its support radius is 2 h.
    SplineSums(const Lattice& lattice, double width) : dimensions(lattice.dimensions) {
        for (int k = 0; k < dimensions; ++k) {
            to_h[k] = lattice.step[k] / width;
            support_radius[k] = 2 / to_h[k];
        }
    }

    // First node of a tile within a point's reach along an axis, and the end of those; `from` is the tile's first node less the
    // point's position.
    KOKKOS_INLINE_FUNCTION void within(int axis, double from, int& begin, int& end) const {
        begin = math::max(0, -static_cast<int>(math::floor(support_radius[axis] + from)));
        end = math::min(tile_edge, static_cast<int>(math::floor(support_radius[axis] - from)) + 1);
    }

    // Adds to sum[8 or 1][8][8] for the points with keep(number).
    template <class Keep>
    KOKKOS_INLINE_FUNCTION void add(const Points& p, const int c[3], const Keep& keep, double* sum) const {
        const auto& window = p.window;
        const int per_tile = dimensions == 3 ? bins_edge * bins_edge * bins_edge : bins_edge * bins_edge;
        int first[3] = {0, 0, 0}, last[3] = {0, 0, 0}; // bins
        for (int k = 0; k < dimensions; ++k) {
            first[k] = static_cast<int>(math::floor((tile_edge * c[k] - support_radius[k]) / 2));
            last[k] = static_cast<int>(math::floor((tile_edge * (c[k] + 1) - 1 + support_radius[k]) / 2));
        }
        for (int bz = first[2]; bz <= last[2]; ++bz) {
            for (int by = first[1]; by <= last[1]; ++by) {
                for (int tx = first[0] >> 2; tx <= last[0] >> 2; ++tx) {
                    const int t[3] = {tx, by >> 2, dimensions == 3 ? bz >> 2 : 0};
                    if (!window.contains(t)) continue;
                    const int tile = p.tile(window.index(t[0], t[1], t[2]));
                    if (tile < 0) continue;
                    const int row =
                        tile * per_tile + bins_edge * ((by & 3) + bins_edge * (dimensions == 3 ? bz & 3 : 0));
                    const int begin = p.begin(row + math::max(first[0] - 4 * tx, 0));
                    const int end = p.begin(row + math::min(last[0] - 4 * tx, 3) + 1);
                    for (int i = begin; i < end; ++i) {
                        if (keep(i)) add_point(p, c, i, sum);
                    }
                }
            }
        }
    }

private:
    KOKKOS_INLINE_FUNCTION void add_point(const Points& p, const int c[3], int i, double* sum) const {
        const double x = tile_edge * c[0] - p.position[0](i), y = tile_edge * c[1] - p.position[1](i);
        const double z = dimensions == 3 ? tile_edge * c[2] - p.position[2](i) : 0;
        int y_begin, y_end, z_begin = 0, z_end = 1;
        within(1, y, y_begin, y_end);
        if (dimensions == 3) within(2, z, z_begin, z_end);
        if (y_begin >= y_end || z_begin >= z_end) return;
        double wx[tile_edge], wy[tile_edge];
        for (int k = 0; k < tile_edge; ++k) wx[k] = cubic_spline((x + k) * to_h[0]);
        for (int k = y_begin; k < y_end; ++k) wy[k] = cubic_spline((y + k) * to_h[1]);
        for (int m = z_begin; m < z_end; ++m) {
            const double wz = dimensions == 3 ? cubic_spline((z + m) * to_h[2]) : 1;
            double* layer = sum + tile_edge * tile_edge * m;
            for (int j = y_begin; j < y_end; ++j) {
                const double w = wz * wy[j];
                for (int k = 0; k < tile_edge; ++k) layer[tile_edge * j + k] += w * wx[k];
            }
        }
    }
};

} // namespace treacle::surface
