#include "surface/field/implicit_function.hpp"

#include "surface/field/spline_sums.hpp"

#include <cmath>

namespace treacle::surface {

namespace {
// Particles of a block of 2 x 2 x 2 bins (one of 2 x 2 in 2D), of 8 (4) on average, below which it is not deep in the liquid.
constexpr int full_block_3d = 4, full_block_2d = 3;
constexpr double inside_margin = 0.1; // in spacings, of nodes beside tiles that were not summed over

KOKKOS_INLINE_FUNCTION int count_in_bin(const Points& points, const int bin[3], int dimensions) {
    int begin, end;
    points_of_bin(points, bin, dimensions, begin, end);
    return end - begin;
}
} // namespace

// A tile is full when every block of 2 bins an edge of it and around it holds half of a block's particles or more, and
// empty when no bin within the support holds any. Tiles at faces where the surface is cut are never full.
void ImplicitFunction::classify(
    const Lattice& lattice, const CellBox& box, const Points& points, double support_cells) {
    const auto& window = field_.window;
    reserve(code_, static_cast<std::size_t>(window.size()));
    const auto code = code_;
    const auto l = lattice;
    const auto p = points;
    const int dimensions = lattice.dimensions;
    const int least = dimensions == 3 ? full_block_3d : full_block_2d;
    const int around = static_cast<int>(std::ceil(support_cells / 2)); // bins
    Kokkos::parallel_for(
        "treacle::clear_codes", static_cast<int>(window.size()), KOKKOS_LAMBDA(int t) { code(t) = tile_empty; });
    Kokkos::parallel_for(
        "treacle::classify_tiles", static_cast<int>(box.size()), KOKKOS_LAMBDA(int t) {
            int c[3];
            box.cell(t, c);
            bool cut = false;
            for (int k = 0; k < dimensions; ++k) {
                cut = cut || tile_edge * c[k] <= l.lo[k] || tile_edge * (c[k] + 1) > l.hi[k] - 1;
            }
            const int z_blocks = dimensions == 3 ? 4 : 1, z_bins = dimensions == 3 ? 2 : 1;
            bool full = !cut;
            for (int bz = 0; bz < z_blocks && full; ++bz) {
                for (int by = 0; by < 4 && full; ++by) {
                    for (int bx = 0; bx < 4 && full; ++bx) {
                        int count = 0;
                        for (int z = 0; z < z_bins; ++z) {
                            for (int y = 0; y < 2; ++y) {
                                for (int x = 0; x < 2; ++x) {
                                    const int bin[3] = {4 * c[0] + 2 * bx - 2 + x, 4 * c[1] + 2 * by - 2 + y,
                                        dimensions == 3 ? 4 * c[2] + 2 * bz - 2 + z : 0};
                                    count += count_in_bin(p, bin, dimensions);
                                }
                            }
                        }
                        full = count >= least;
                    }
                }
            }
            int state = tile_full;
            if (!full) {
                state = tile_empty;
                const int z_around = dimensions == 3 ? around : 0;
                for (int z = -z_around; z < (dimensions == 3 ? bins_edge + around : 1) && state != 0; ++z) {
                    for (int y = -around; y < bins_edge + around && state != 0; ++y) {
                        for (int x = -around; x < bins_edge + around && state != 0; ++x) {
                            const int bin[3] = {4 * c[0] + x, 4 * c[1] + y, dimensions == 3 ? 4 * c[2] + z : 0};
                            if (count_in_bin(p, bin, dimensions) > 0) state = 0;
                        }
                    }
                }
            }
            code(window.index(c[0], c[1], c[2])) = state;
        });
}

// u(x) = V sum_p B_h(x - x_p), product of cubic B-splines along the axes, at the nodes of this rank's tiles; the function
// starts with (u - 1/2) / B_h(0).
void ImplicitFunction::sum_splines(const Lattice& lattice, const Points& points, const Options& options) {
    const int nodes = lattice.nodes_per_tile();
    const double h = options.kernel_width * options.spacing, slope = (2.0 / 3) / options.kernel_width;
    const double scale = math::pow(options.spacing / h, double(lattice.dimensions));
    const SplineSums sums(lattice, h);
    const auto value = field_.value, fraction = fraction_;
    const auto own = own_slots_, tiles = tiles_;
    const auto window = field_.window;
    const auto p = points;
    Kokkos::parallel_for(
        "treacle::sum_splines", own_, KOKKOS_LAMBDA(int item) {
            const int s = own(item);
            int c[3];
            window.cell(tiles(s), c);
            double sum[512];
            for (double& one : sum) one = 0;
            sums.add(
                p, c, [](int) { return true; }, sum);
            const std::int64_t to = std::int64_t(s) * nodes;
            for (int k = 0; k < nodes; ++k) {
                const double u = sum[k] * scale;
                fraction(to + k) = u;
                value(to + k) = (u - 0.5) / slope;
            }
        });
}

namespace {
constexpr int most_taps = tile_edge - 1;              // on either side
constexpr int block_edge = tile_edge + 2 * most_taps; // nodes that a tile's are filtered from

struct Taps {
    double weight[3][2 * most_taps + 1];
    int half_width[3];

    Taps(const Lattice& lattice, double h) {
        for (int k = 0; k < 3; ++k) {
            const double to_h = lattice.step[k] / h;
            half_width[k] = k < lattice.dimensions ? std::min(most_taps, static_cast<int>(std::ceil(2 / to_h)) - 1) : 0;
            double sum = 0;
            for (int m = -half_width[k]; m <= half_width[k]; ++m)
                sum += weight[k][m + half_width[k]] = cubic_spline(m * to_h);
            for (int m = 0; m <= 2 * half_width[k]; ++m) weight[k][m] /= sum;
        }
    }
};

// Number of a node behind a wall's face: that of its mirror image.
KOKKOS_INLINE_FUNCTION int mirrored(const Lattice& l, int axis, int node) {
    if (l.mirror[0][axis] && node < l.lo[axis]) return 2 * l.lo[axis] - node;
    if (l.mirror[1][axis] && node > l.hi[axis]) return 2 * l.hi[axis] - node;
    return node;
}

struct LineReader {
    NodeField field;
    Lattice lattice;
    int half_width;
    double width;

    // The smoothed indicator of a line of nodes along x, from `half_width` before a tile to `half_width` behind it.
    KOKKOS_INLINE_FUNCTION void read(int tile, int y, int z, double* line) const {
        const bool plain = (!lattice.mirror[0][0] || tile_edge * tile - half_width >= lattice.lo[0]) &&
                           (!lattice.mirror[1][0] || tile_edge * (tile + 1) + half_width - 1 <= lattice.hi[0]);
        const int count = tile_edge + 2 * half_width;
        if (plain) {
            for (int t = tile - 1; t <= tile + 1; ++t) {
                const int node[3] = {tile_edge * t, y, z};
                const int s = field.slot(node);
                const int begin = math::max(0, tile_edge * (t - tile) + half_width);
                const int end = math::min(count, tile_edge * (t - tile + 1) + half_width);
                if (s < 0) {
                    for (int i = begin; i < end; ++i) line[i] = s == tile_full ? far : -far;
                } else {
                    const double* from = &field.value(std::int64_t(s) * field.nodes() + field.local(node));
                    for (int i = begin; i < end; ++i) line[i] = from[i - half_width - tile_edge * (t - tile)];
                }
            }
        } else {
            for (int i = 0; i < count; ++i) {
                const int node[3] = {mirrored(lattice, 0, tile_edge * tile + i - half_width), y, z};
                line[i] = field.at(node);
            }
        }
        for (int i = 0; i < count; ++i) line[i] = math::min(1.0, math::max(0.0, 0.5 + line[i] / width));
    }
};
} // namespace

// Van Cittert: F += (u - B_h * H[F]) / B_h(0), with H the indicator of F > 0 smoothed over the interface's width. Nodes
// behind walls mirror those before them.
void ImplicitFunction::deconvolve(const Lattice& lattice, const Options& options) {
    const int dimensions = lattice.dimensions, depth = lattice.depth();
    const Taps taps(lattice, options.kernel_width * options.spacing);
    const double slope = (2.0 / 3) / options.kernel_width;
    const auto field = field_;
    const auto fraction = fraction_, next = next_;
    const auto own = own_slots_, tiles = tiles_;
    const auto l = lattice;
    const LineReader reader{field_, lattice, taps.half_width[0], options.interface_width};
    Kokkos::parallel_for(
        "treacle::deconvolve", own_, KOKKOS_LAMBDA(int item) {
            const int s = own(item);
            int c[3];
            field.window.cell(tiles(s), c);
            const int rx = taps.half_width[0], ry = taps.half_width[1], rz = taps.half_width[2];
            double planes[block_edge][tile_edge][tile_edge]; // filtered along x and y
            for (int z = 0; z < depth + 2 * rz; ++z) {
                double rows[block_edge][tile_edge]; // filtered along x
                const int node_z = dimensions == 3 ? mirrored(l, 2, tile_edge * c[2] + z - rz) : 0;
                for (int y = 0; y < tile_edge + 2 * ry; ++y) {
                    double line[block_edge];
                    reader.read(c[0], mirrored(l, 1, tile_edge * c[1] + y - ry), node_z, line);
                    double sum[tile_edge] = {0, 0, 0, 0, 0, 0, 0, 0};
                    for (int m = 0; m <= 2 * rx; ++m) {
                        for (int i = 0; i < tile_edge; ++i) sum[i] += taps.weight[0][m] * line[i + m];
                    }
                    for (int i = 0; i < tile_edge; ++i) rows[y][i] = sum[i];
                }
                for (int y = 0; y < tile_edge; ++y) {
                    double sum[tile_edge] = {0, 0, 0, 0, 0, 0, 0, 0};
                    for (int m = 0; m <= 2 * ry; ++m) {
                        for (int i = 0; i < tile_edge; ++i) sum[i] += taps.weight[1][m] * rows[y + m][i];
                    }
                    for (int i = 0; i < tile_edge; ++i) planes[z][y][i] = sum[i];
                }
            }
            const std::int64_t to = std::int64_t(s) * depth * 64;
            for (int z = 0; z < depth; ++z) {
                for (int y = 0; y < tile_edge; ++y) {
                    double sum[tile_edge] = {0, 0, 0, 0, 0, 0, 0, 0};
                    for (int m = 0; m <= 2 * rz; ++m) {
                        for (int i = 0; i < tile_edge; ++i) sum[i] += taps.weight[2][m] * planes[z + m][y][i];
                    }
                    for (int i = 0; i < tile_edge; ++i) {
                        const std::int64_t k = to + 64 * z + 8 * y + i;
                        next(k) = field.value(k) + (fraction(k) - sum[i]) / slope;
                    }
                }
            }
        });
    const auto value = field_.value;
    Kokkos::parallel_for(
        "treacle::take_deconvolved", own_ * depth * 64, KOKKOS_LAMBDA(int k) {
            const std::int64_t at = std::int64_t(own(k / (depth * 64))) * depth * 64 + k % (depth * 64);
            value(at) = next(at);
        });
}

void ImplicitFunction::shift(const Lattice& lattice, double iso) {
    const int nodes = lattice.nodes_per_tile();
    const auto value = field_.value;
    const auto own = own_slots_;
    Kokkos::parallel_for(
        "treacle::shift_surface", own_ * nodes,
        KOKKOS_LAMBDA(int k) { value(std::int64_t(own(k / nodes)) * nodes + k % nodes) -= iso; });
}

// Nodes beside full tiles are in the liquid, those beside empty tiles are not: surfaces end in tiles that have values.
// Behind the faces at which the surface is cut there are no tiles.
void ImplicitFunction::close_borders(const Lattice& lattice) {
    const auto field = field_;
    const auto l = lattice;
    const auto own = own_slots_, tiles = tiles_;
    const int nodes = field.nodes(), dimensions = field.dimensions;
    Kokkos::parallel_for(
        "treacle::close_borders", own_ * nodes, KOKKOS_LAMBDA(int item) {
            const int s = own(item / nodes), local = item % nodes;
            const int i[3] = {local & 7, (local >> 3) & 7, local >> 6};
            int c[3], lo[3] = {0, 0, 0}, hi[3] = {0, 0, 0};
            field.window.cell(tiles(s), c);
            bool border = false;
            for (int k = 0; k < dimensions; ++k) {
                lo[k] = i[k] == 0 ? -1 : 0;
                hi[k] = i[k] == tile_edge - 1 ? 1 : 0;
                border = border || lo[k] != 0 || hi[k] != 0;
            }
            if (!border) return;
            bool full = false, empty = false;
            for (int z = lo[2]; z <= hi[2]; ++z) {
                for (int y = lo[1]; y <= hi[1]; ++y) {
                    for (int x = lo[0]; x <= hi[0]; ++x) {
                        const int t[3] = {c[0] + x, c[1] + y, c[2] + z};
                        bool there = field.window.contains(t);
                        for (int k = 0; k < dimensions; ++k) {
                            there = there && tile_edge * (t[k] + 1) > l.lo[k] && tile_edge * t[k] <= l.hi[k];
                        }
                        if (!there) continue;
                        const int state = field.state(field.window.index(t[0], t[1], t[2]));
                        full = full || state == tile_full;
                        empty = empty || state == tile_empty;
                    }
                }
            }
            double& value = field.value(std::int64_t(s) * nodes + local);
            if (full) value = math::max(value, inside_margin);
            if (empty && !full) value = math::min(value, -inside_margin);
        });
}

namespace {
struct TileBall {
    Vec3 middle{0, 0, 0};
    double radius = 0;
};

TileBall ball_of(const Lattice& lattice, const int c[3]) {
    TileBall out;
    double square = 0;
    for (int k = 0; k < lattice.dimensions; ++k) {
        out.middle[static_cast<std::size_t>(k)] = lattice.grid.origin[k] + (c[k] + 0.5) * tile_edge * lattice.step[k];
        square += std::pow((tile_edge / 2.0 + 1) * lattice.step[k], 2);
    }
    out.radius = std::sqrt(square);
    return out;
}
} // namespace

// Full tiles that a solid's surface crosses get values; those inside of a solid are empty.
void ImplicitFunction::settle_near_solids(
    const Lattice& lattice, const CellBox& box, const Solids& solids, double spacing) {
    for (int t = 0; t < static_cast<int>(box.size()); ++t) {
        int c[3];
        box.cell(t, c);
        int& code = codes_[static_cast<std::size_t>(field_.window.index(c[0], c[1], c[2]))];
        if (code == tile_empty) continue;
        const auto ball = ball_of(lattice, c);
        const double distance = solids.distance(ball.middle);
        if (distance < -ball.radius - spacing)
            code = tile_empty;
        else if (distance < ball.radius && code == tile_full)
            code = 0;
    }
}

void ImplicitFunction::cut_at_solids(const Lattice& lattice, const Solids& solids, double spacing) {
    const int nodes = field_.nodes();
    auto value = on_host(field_.value);
    auto marks = on_host(at_solid_);
    const auto own = on_host(own_slots_), tiles = on_host(tiles_);
    for (int k = 0; k < own_; ++k) {
        const int s = own(k);
        int c[3];
        field_.window.cell(tiles(s), c);
        const auto ball = ball_of(lattice, c);
        if (solids.distance(ball.middle) > ball.radius) continue;
        for (int n = 0; n < nodes; ++n) {
            const auto at = static_cast<std::int64_t>(s) * nodes + n;
            if (value(at) < -2) continue;
            const int node[3] = {
                tile_edge * c[0] + (n & 7), tile_edge * c[1] + (n >> 3 & 7), tile_edge * c[2] + (n >> 6)};
            Vec3 x{0, 0, 0};
            for (int axis = 0; axis < lattice.dimensions; ++axis)
                x[static_cast<std::size_t>(axis)] = lattice.position(axis, node[axis]);
            const double solid = solids.distance(x) / spacing;
            if (solid >= value(at)) continue;
            value(at) = solid;
            marks(at) = 1;
        }
    }
    Kokkos::deep_copy(field_.value, value);
    Kokkos::deep_copy(at_solid_, marks);
}

void ImplicitFunction::build(const Decomposition& decomposition, const Lattice& lattice, const Points& points,
    const Options& options, const Solids* solids) {
    const CellBox box = decomposition.box();
    const auto& window = points.window;
    field_.window = window;
    field_.dimensions = lattice.dimensions;
    double support = 0; // in lattice cells
    for (int k = 0; k < lattice.dimensions; ++k) {
        support = std::max(support, 2 * options.kernel_width * options.spacing / lattice.step[k]);
    }
    classify(lattice, box, points, support);
    if (options.liquid >= 0) settle_liquids(box, points, support, options.liquid);
    const auto codes = on_host(code_);
    codes_.assign(codes.data(), codes.data() + window.size());
    if (solids != nullptr) settle_near_solids(lattice, box, *solids, options.spacing);
    slots_ = halo_.connect(decomposition, window, codes_);

    std::vector<int> tiles, own;
    for (std::size_t t = 0; t < codes_.size(); ++t) {
        if (codes_[t] < 0) continue;
        int c[3];
        window.cell(static_cast<int>(t), c);
        if (box.contains(c)) own.push_back(codes_[t]);
        tiles.push_back(static_cast<int>(t));
    }
    own_ = static_cast<int>(own.size());
    assign(field_.state, codes_);
    assign(tiles_, tiles);
    assign(own_slots_, own);
    const auto values = static_cast<std::size_t>(slots_) * static_cast<std::size_t>(lattice.nodes_per_tile());
    reserve(field_.value, values);
    reserve(fraction_, values);
    reserve(next_, values);
    reserve(at_solid_, solids != nullptr ? values : 0);
    if (solids != nullptr) Kokkos::deep_copy(at_solid_, 0.0);

    sum_splines(lattice, points, options);
    for (int pass = 0; pass < options.deconvolution_passes; ++pass) {
        halo_.gather(field_);
        deconvolve(lattice, options);
    }
    if (options.iso != 0) shift(lattice, options.iso);
    if (options.liquid >= 0) separate(lattice, points, options);
    if (solids != nullptr) cut_at_solids(lattice, *solids, options.spacing);
    close_borders(lattice);
    halo_.gather(field_);
    if (solids != nullptr) {
        NodeField marks = field_;
        marks.value = at_solid_;
        halo_.gather(marks);
    }
}

} // namespace treacle::surface
