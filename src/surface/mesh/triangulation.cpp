#include "surface/mesh/triangulation.hpp"

#include "kokkos/scan.hpp"
#include "mpi/shared_node_sum.hpp"
#include "surface/mesh/cell_polygons.hpp"

#include <algorithm>

namespace treacle::surface {

namespace {
// Vertices of a node: one on each edge from it along an axis, one on the node itself where the surface is cut there, and
// one in the middle of the cell above it.
constexpr int cut_bit = 3, centre_bit = 4;
// Nearest that a vertex comes to a node, over the edge's length: triangles keep an area.
constexpr double margin = 1e-3;

KOKKOS_INLINE_FUNCTION int bits_below(int mask, int bit) {
    int count = 0;
    for (int b = 0; b < bit; ++b) count += mask >> b & 1;
    return count;
}

KOKKOS_INLINE_FUNCTION int cells_per_slot(int dimensions) { return dimensions == 3 ? 729 : 81; }

KOKKOS_INLINE_FUNCTION std::int64_t pack_key(const int node[3]) {
    constexpr std::int64_t half = LatticeKey::half;
    return (node[0] + half) | (node[1] + half) << 21 | (node[2] + half) << 42;
}
} // namespace

KOKKOS_INLINE_FUNCTION int Triangulation::View::edge_vertex(const int node[3], int axis) const {
    int from[3] = {node[0], node[1], node[2]}, to[3] = {node[0], node[1], node[2]};
    ++to[axis];
    int bit = axis;
    if (lattice.outside(from) || lattice.outside(to)) {
        bit = cut_bit;
        if (lattice.outside(from)) from[axis] = to[axis];
    }
    const int s = field.slot(from);
    if (s < 0) return -1;
    const std::int64_t at = std::int64_t(s) * field.nodes() + field.local(from);
    return first(at) + bits_below(mask(at), bit);
}

KOKKOS_INLINE_FUNCTION int Triangulation::View::centre_vertex(const int node[3]) const {
    const std::int64_t at = std::int64_t(field.slot(node)) * field.nodes() + field.local(node);
    return first(at) + bits_below(mask(at), centre_bit);
}

KOKKOS_INLINE_FUNCTION bool Triangulation::View::own_cell(const int c[3]) const {
    for (int k = 0; k < lattice.dimensions; ++k) {
        const int tile = math::min(math::max(NodeField::tile(c[k]), 0), lattice.grid.count[k] - 1);
        if (tile < box.lo[k] || tile >= box.hi[k]) return false;
    }
    return true;
}

KOKKOS_INLINE_FUNCTION bool Triangulation::View::cell(const int tile[3], int item, int out[3]) const {
    const int local[3] = {item % 9 - 1, item / 9 % 9 - 1, lattice.dimensions == 3 ? item / 81 - 1 : 0};
    for (int k = 0; k < 3; ++k) {
        out[k] = k < lattice.dimensions ? tile_edge * tile[k] + local[k] : 0;
        if (k >= lattice.dimensions) continue;
        // Cells before a tile's own are only there where the surface is cut.
        if (local[k] < 0 && tile_edge * tile[k] != lattice.lo[k]) return false;
        if (local[k] >= 0 && out[k] < lattice.lo[k]) return false; // of a periodic image
        if (out[k] < cells.lo[k] || out[k] >= cells.hi[k]) return false;
    }
    return true;
}

void Triangulation::mark_vertices(const View& view, const Array<int>& tiles, int slots) {
    const int nodes = view.field.nodes();
    const auto mask = mask_, first = first_;
    Kokkos::parallel_for(
        "treacle::mark_vertices", std::int64_t(slots) * nodes, KOKKOS_LAMBDA(std::int64_t at) {
            const auto& l = view.lattice;
            const int local = static_cast<int>(at % nodes);
            int c[3], bits = 0;
            view.field.window.cell(tiles(static_cast<int>(at / nodes)), c);
            int node[3] = {
                tile_edge * c[0] + (local & 7), tile_edge * c[1] + (local >> 3 & 7), tile_edge * c[2] + (local >> 6)};
            bool there = !l.outside(node);
            for (int k = 0; k < l.dimensions; ++k)
                there = there && node[k] >= view.cells.lo[k] && node[k] <= view.cells.hi[k];
            if (there) {
                const bool inside = view.field.value(at) > 0;
                for (int k = 0; k < l.dimensions; ++k) {
                    if (inside && (node[k] == l.lo[k] || node[k] == l.hi[k])) bits |= 1 << cut_bit;
                    if (node[k] == l.hi[k] || node[k] == view.cells.hi[k]) continue; // no cell has the edge
                    ++node[k];
                    if ((view.field.at(node) > 0) != inside) bits |= 1 << k;
                    --node[k];
                }
            }
            mask(at) = bits;
            first(at) = bits_below(bits, 5);
        });
}

namespace {
// link_edges() of a cell of the lattice; false for one that the surface does not pass.
KOKKOS_INLINE_FUNCTION bool link_cell(const Triangulation::View& view, const int c[3], int next[12]) {
    double value[8];
    int signs = 0;
    const int last[3] = {c[0] + 1, c[1] + 1, c[2] + 1};
    bool in_tile = !view.lattice.outside(c) && !view.lattice.outside(last);
    for (int k = 0; k < 3; ++k) in_tile = in_tile && NodeField::tile(c[k]) == NodeField::tile(last[k]);
    const int slot = in_tile ? view.field.slot(c) : 0;
    if (slot < 0) return false;
    const std::int64_t first = std::int64_t(slot) * view.field.nodes() + view.field.local(c);
    for (int k = 0; k < 8; ++k) {
        const int x = k & 1, y = k >> 1 & 1, z = k >> 2;
        const int node[3] = {c[0] + x, c[1] + y, c[2] + z};
        value[k] = in_tile ? view.field.value(first + x + tile_edge * (y + tile_edge * z)) : view.value(node);
        signs |= (value[k] > 0 ? 1 : 0) << k;
    }
    if (signs == 0 || signs == 255) return false;
    link_edges(value, next);
    return true;
}
} // namespace

// Cells one of whose polygons has no triangulation without a vertex in the middle; one polygon of a cell at most.
void Triangulation::mark_centres(const View& view, const Array<int>& tiles, int slots) {
    const int per_slot = cells_per_slot(view.lattice.dimensions);
    const auto mask = mask_, first = first_;
    if (view.lattice.dimensions == 2) return;
    Kokkos::parallel_for(
        "treacle::mark_centres", std::int64_t(slots) * per_slot, KOKKOS_LAMBDA(std::int64_t item) {
            int tile[3], c[3];
            view.field.window.cell(tiles(static_cast<int>(item / per_slot)), tile);
            if (!view.cell(tile, static_cast<int>(item % per_slot), c) || view.lattice.outside(c)) return;
            int next[12], n = 0, faces[12];
            if (!link_cell(view, c, next)) return;
            follow_polygons(
                next, [&](int edge) { faces[n++] = edge_faces(edge); },
                [&] {
                    int triangles[10][3];
                    if (n >= 8 && triangulate_polygon(
                                      n, faces, [](int, int) { return 1.0; }, triangles) < 0) {
                        const std::int64_t node =
                            std::int64_t(view.field.slot(c)) * view.field.nodes() + view.field.local(c);
                        mask(node) |= 1 << centre_bit;
                        first(node) = bits_below(mask(node), 5);
                    }
                    n = 0;
                });
        });
}

void Triangulation::compute_vertices(const View& view, const ImplicitFunction& function) {
    const int nodes = view.field.nodes();
    const auto mask = mask_, first = first_;
    const auto tiles = function.tiles();
    const auto at_solid = function.at_solid();
    const bool solids = at_solid.extent(0) > 0;
    const auto position = patch_.position;
    const auto key = patch_.key;
    const auto fixed = patch_.fixed;
    Kokkos::parallel_for(
        "treacle::compute_vertices", std::int64_t(function.slots()) * nodes, KOKKOS_LAMBDA(std::int64_t at) {
            const int bits = mask(at);
            if (bits == 0) return;
            const auto& l = view.lattice;
            const int local = static_cast<int>(at % nodes);
            int c[3];
            view.field.window.cell(tiles(static_cast<int>(at / nodes)), c);
            int node[3] = {
                tile_edge * c[0] + (local & 7), tile_edge * c[1] + (local >> 3 & 7), tile_edge * c[2] + (local >> 6)};
            int cut = 0; // axes at right angles to faces that the node lies on
            for (int k = 0; k < l.dimensions; ++k) {
                if (node[k] == l.lo[k] || node[k] == l.hi[k]) cut |= 1 << k;
            }
            int v = first(at);
            for (int b = 0; b < 5; ++b) {
                if ((bits >> b & 1) == 0) continue;
                double t = 0;
                int stays = cut;
                if (b < 3) {
                    const double here = view.field.value(at);
                    ++node[b];
                    const double there = view.field.at(node);
                    if (solids) {
                        const std::int64_t other = std::int64_t(view.field.slot(node)) * nodes + view.field.local(node);
                        if (at_solid(at) != 0 || at_solid(other) != 0) stays |= 8;
                    }
                    --node[b];
                    t = math::min(1 - margin, math::max(margin, here / (here - there)));
                    stays &= ~(1 << b);
                }
                if (b == cut_bit) stays |= 8;
                int doubled[3] = {0, 0, 0};
                for (int k = 0; k < 3; ++k) {
                    const bool flat = k >= l.dimensions;
                    doubled[k] = flat ? 0 : 2 * (node[k] + tile_edge * l.base[k]) + (b == k || b == centre_bit ? 1 : 0);
                    position(3 * std::int64_t(v) + k) = flat ? 0
                                                             : l.position(k, node[k] + (b == k               ? t
                                                                                           : b == centre_bit ? 0.5
                                                                                                             : 0));
                }
                key(v) = pack_key(doubled);
                fixed(v) = stays;
                ++v;
            }
        });
}

namespace {
// Calls visit(polygon) for each polygon of a cell.
template <class Visit>
KOKKOS_INLINE_FUNCTION void for_each_polygon(const Triangulation::View& view, const int c[3], const Visit& visit) {
    int next[12];
    if (!link_cell(view, c, next)) return;
    Polygon polygon;
    follow_polygons(
        next,
        [&](int edge) {
            const int corner = edge_corner(edge);
            const int node[3] = {c[0] + (corner & 1), c[1] + (corner >> 1 & 1), c[2] + (corner >> 2)};
            polygon.add(view.edge_vertex(node, edge / 4), edge_faces(edge));
        },
        [&] {
            polygon.close();
            if (polygon.n >= 3) visit(polygon);
            polygon = Polygon();
        });
}

// Segments of a cell in 2D: each from a vertex to the next with the liquid on its left.
template <class Visit>
KOKKOS_INLINE_FUNCTION void for_each_segment(const Triangulation::View& view, const int c[3], const Visit& visit) {
    constexpr int corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    double v[4];
    for (int k = 0; k < 4; ++k) {
        const int node[3] = {c[0] + corners[k][0], c[1] + corners[k][1], 0};
        v[k] = view.value(node);
    }
    int vertex[4], count = 0;
    bool enters[4];
    for (int k = 0; k < 4; ++k) {
        const int n = (k + 1) & 3;
        if ((v[k] > 0) == (v[n] > 0)) continue;
        const int node[3] = {c[0] + (k == 1 ? 1 : 0), c[1] + (k == 2 ? 1 : 0), 0};
        vertex[count] = view.edge_vertex(node, k & 1);
        enters[count] = v[n] > 0;
        ++count;
    }
    const bool over_liquid = count == 4 && joined(v);
    for (int k = 0; k < count; ++k) {
        if (enters[k]) continue;
        const int other = over_liquid || count == 2 ? (k + 1) % count : (k + count - 1) % count;
        if (vertex[k] != vertex[other]) visit(vertex[k], vertex[other]);
    }
}
} // namespace

// The centre vertex lies in the middle of its polygon.
void Triangulation::compute_centres(const View& view, const Array<int>& tiles, int slots) {
    if (view.lattice.dimensions == 2) return;
    const int per_slot = cells_per_slot(3);
    const auto mask = mask_;
    const auto position = patch_.position;
    Kokkos::parallel_for(
        "treacle::compute_centres", std::int64_t(slots) * per_slot, KOKKOS_LAMBDA(std::int64_t item) {
            int tile[3], c[3];
            view.field.window.cell(tiles(static_cast<int>(item / per_slot)), tile);
            if (!view.cell(tile, static_cast<int>(item % per_slot), c) || view.lattice.outside(c)) return;
            const std::int64_t node = std::int64_t(view.field.slot(c)) * view.field.nodes() + view.field.local(c);
            if ((mask(node) >> centre_bit & 1) == 0) return;
            const std::int64_t v = view.centre_vertex(c);
            for_each_polygon(view, c, [&](const Polygon& polygon) {
                int triangles[10][3];
                if (polygon.n < 8 || triangulate_polygon(
                                         polygon.n, polygon.faces, [](int, int) { return 1.0; }, triangles) >= 0)
                    return;
                for (int k = 0; k < 3; ++k) {
                    double sum = 0;
                    for (int i = 0; i < polygon.n; ++i) sum += position(3 * std::int64_t(polygon.vertex[i]) + k);
                    position(3 * v + k) = sum / polygon.n;
                }
            });
        });
}

void Triangulation::count_triangles(const View& view, const Array<int>& tiles, int slots) {
    const int dimensions = view.lattice.dimensions, per_slot = cells_per_slot(dimensions);
    const auto counts = counts_;
    Kokkos::parallel_for(
        "treacle::count_triangles", std::int64_t(slots) * per_slot, KOKKOS_LAMBDA(std::int64_t item) {
            counts(item) = 0;
            int tile[3], c[3], count = 0;
            view.field.window.cell(tiles(static_cast<int>(item / per_slot)), tile);
            if (!view.cell(tile, static_cast<int>(item % per_slot), c)) return;
            if (dimensions == 2) {
                for_each_segment(view, c, [&](int, int) { ++count; });
            } else {
                for_each_polygon(view, c, [&](const Polygon& polygon) {
                    int triangles[10][3];
                    const bool centre =
                        polygon.n >= 8 && triangulate_polygon(
                                              polygon.n, polygon.faces, [](int, int) { return 1.0; }, triangles) < 0;
                    count += centre ? polygon.n : polygon.n - 2;
                });
            }
            counts(item) = count;
        });
}

void Triangulation::fill_triangles(const View& view, const Array<int>& tiles, int slots) {
    const int dimensions = view.lattice.dimensions, per_slot = cells_per_slot(dimensions);
    const auto counts = counts_;
    const auto corner = patch_.corner, own = patch_.own;
    const auto position = patch_.position;
    Kokkos::parallel_for(
        "treacle::fill_triangles", std::int64_t(slots) * per_slot, KOKKOS_LAMBDA(std::int64_t item) {
            int to = counts(item);
            if (counts(item + 1) == to) return;
            int tile[3], c[3];
            view.field.window.cell(tiles(static_cast<int>(item / per_slot)), tile);
            view.cell(tile, static_cast<int>(item % per_slot), c);
            const int mine = view.own_cell(c) ? 1 : 0;
            if (dimensions == 2) {
                for_each_segment(view, c, [&](int a, int b) {
                    corner(2 * to) = a;
                    corner(2 * to + 1) = b;
                    own(to) = mine;
                    ++to;
                });
                return;
            }
            for_each_polygon(view, c, [&](const Polygon& polygon) {
                int triangles[10][3];
                const auto length = [&](int i, int j) {
                    double square = 0;
                    for (int k = 0; k < 3; ++k) {
                        const double d = position(3 * std::int64_t(polygon.vertex[i]) + k) -
                                         position(3 * std::int64_t(polygon.vertex[j]) + k);
                        square += d * d;
                    }
                    return square;
                };
                const int count = triangulate_polygon(polygon.n, polygon.faces, length, triangles);
                for (int t = 0; t < count; ++t, ++to) {
                    for (int k = 0; k < 3; ++k) corner(3 * std::int64_t(to) + k) = polygon.vertex[triangles[t][k]];
                    own(to) = mine;
                }
                if (count >= 0) return;
                const int centre = view.centre_vertex(c);
                for (int i = 0; i < polygon.n; ++i, ++to) {
                    corner(3 * std::int64_t(to)) = polygon.vertex[i];
                    corner(3 * std::int64_t(to) + 1) = polygon.vertex[(i + 1) % polygon.n];
                    corner(3 * std::int64_t(to) + 2) = centre;
                    own(to) = mine;
                }
            });
        });
}

const Patch& Triangulation::build(
    const Lattice& lattice, const CellBox& box, const ImplicitFunction& function, int layers) {
    const int slots = box.empty() ? 0 : function.slots();
    const auto& field = function.field();
    const std::size_t nodes = static_cast<std::size_t>(slots) * static_cast<std::size_t>(lattice.nodes_per_tile());
    const std::size_t cells =
        static_cast<std::size_t>(slots) * static_cast<std::size_t>(cells_per_slot(lattice.dimensions));
    reserve(mask_, nodes);
    reserve(first_, nodes + 1);
    reserve(counts_, cells + 1);
    View view{lattice, field, mask_, first_, patch_.position, box, {}};
    for (int k = 0; k < 3; ++k) {
        const bool flat = k >= lattice.dimensions;
        view.cells.lo[k] = flat ? 0 : std::max(tile_edge * box.lo[k] - layers, lattice.lo[k] - 1);
        view.cells.hi[k] = flat ? 1 : std::min(tile_edge * box.hi[k] + layers, lattice.hi[k] + 1);
    }
    mark_vertices(view, function.tiles(), slots);
    mark_centres(view, function.tiles(), slots);
    patch_.vertices = static_cast<int>(counts_to_offsets(first_, static_cast<int>(nodes)));
    reserve(patch_.position, 3 * static_cast<std::size_t>(patch_.vertices));
    reserve(patch_.key, static_cast<std::size_t>(patch_.vertices));
    reserve(patch_.fixed, static_cast<std::size_t>(patch_.vertices));
    view.position = patch_.position;
    compute_vertices(view, function);
    compute_centres(view, function.tiles(), slots);
    count_triangles(view, function.tiles(), slots);
    patch_.triangles = static_cast<int>(counts_to_offsets(counts_, static_cast<int>(cells)));
    patch_.corners_per_triangle = lattice.dimensions;
    reserve(patch_.corner, static_cast<std::size_t>(lattice.dimensions) * static_cast<std::size_t>(patch_.triangles));
    reserve(patch_.own, static_cast<std::size_t>(patch_.triangles));
    fill_triangles(view, function.tiles(), slots);
    return patch_;
}

} // namespace treacle::surface
