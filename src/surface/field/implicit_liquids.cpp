#include "surface/field/implicit_function.hpp"
#include "surface/field/spline_sums.hpp"

#include <cmath>

namespace treacle::surface {

// Tiles without particles of the liquid within the support are empty; full tiles with others are not full.
void ImplicitFunction::settle_liquids(const CellBox& box, const Points& points, double support_cells, int liquid) {
    const auto& window = field_.window;
    const auto code = code_;
    const auto p = points;
    const int dimensions = field_.dimensions;
    const int around = static_cast<int>(std::ceil(support_cells / 2)); // bins
    Kokkos::parallel_for(
        "treacle::settle_liquids", static_cast<int>(box.size()), KOKKOS_LAMBDA(int t) {
            int c[3];
            box.cell(t, c);
            int& state = code(window.index(c[0], c[1], c[2]));
            if (state == tile_empty) return;
            bool own = false, others = false;
            const int z_around = dimensions == 3 ? around : 0;
            for (int z = -z_around; z < (dimensions == 3 ? bins_edge + around : 1); ++z) {
                for (int y = -around; y < bins_edge + around; ++y) {
                    for (int x = -around; x < bins_edge + around; ++x) {
                        const int bin[3] = {4 * c[0] + x, 4 * c[1] + y, dimensions == 3 ? 4 * c[2] + z : 0};
                        int begin, end;
                        points_of_bin(p, bin, dimensions, begin, end);
                        for (int i = begin; i < end; ++i) {
                            own = own || p.liquid(i) == liquid;
                            others = others || p.liquid(i) != liquid;
                        }
                    }
                }
            }
            if (!own)
                state = tile_empty;
            else if (others && state == tile_full)
                state = 0;
        });
}

// (SF5) F = min(F, (u_l - the largest of the other liquids' u) / (2 B_h(0))): where two liquids touch, both have one surface.
void ImplicitFunction::separate(const Lattice& lattice, const Points& points, const Options& options) {
    int liquids = 0;
    const auto p = points;
    Kokkos::parallel_reduce(
        "treacle::count_liquids", points.count,
        KOKKOS_LAMBDA(int i, int& most) { most = math::max(most, p.liquid(i) + 1); }, Kokkos::Max<int>(liquids));
    const int nodes = lattice.nodes_per_tile(), liquid = options.liquid;
    const double h = options.kernel_width * options.spacing, slope = (2.0 / 3) / options.kernel_width;
    const double scale = math::pow(options.spacing / h, double(lattice.dimensions)) / (2 * slope);
    const SplineSums sums(lattice, h);
    const auto value = field_.value;
    const auto own = own_slots_, tiles = tiles_;
    const auto window = field_.window;
    Kokkos::parallel_for(
        "treacle::separate_liquids", own_, KOKKOS_LAMBDA(int item) {
            const int s = own(item);
            int c[3];
            window.cell(tiles(s), c);
            double mine[512], most[512], sum[512];
            for (int k = 0; k < nodes; ++k) mine[k] = most[k] = 0;
            for (int m = 0; m < liquids; ++m) {
                for (int k = 0; k < nodes; ++k) sum[k] = 0;
                sums.add(
                    p, c, [&](int i) { return p.liquid(i) == m; }, sum);
                for (int k = 0; k < nodes; ++k) {
                    if (m == liquid)
                        mine[k] = sum[k];
                    else
                        most[k] = math::max(most[k], sum[k]);
                }
            }
            const std::int64_t to = std::int64_t(s) * nodes;
            for (int k = 0; k < nodes; ++k) value(to + k) = math::min(value(to + k), (mine[k] - most[k]) * scale);
        });
}

} // namespace treacle::surface
