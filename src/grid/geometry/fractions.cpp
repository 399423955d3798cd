#include "grid/geometry/fractions.hpp"

#include "grid/mac/polyhedron.hpp"
#include "kokkos/scan.hpp"

namespace treacle::grid {

namespace {
// Kinds of cells that are of one sort all through, as numbers below 0: bit 0 of -1 - kind: liquid, bit 1: solid.
constexpr int kinds = 4;
constexpr int kind_of(bool liquid, bool solid) { return -1 - (liquid ? 1 : 0) - (solid ? 2 : 0); }
constexpr int empty_kind = kind_of(false, false);
constexpr int cut_place = 0;           // in written_: cut by a surface
constexpr int unknown_place = -1 - kinds; // in written_: never written

KOKKOS_INLINE_FUNCTION CubeShares shares_of(int kind) {
    const int bits = -1 - kind;
    const double liquid = bits & 1 ? 1 : 0, fluid = bits & 2 ? 0 : 1;
    return {fluid, liquid, fluid * liquid};
}

// What the kernels share of a window.
struct Places {
    FineNodes nodes;
    int up[3]; // 1, and 0 along the flat axis of plane scenes
    WallPlanes walls;

    Places(const FineNodes& of, const WallPlanes& sides) : nodes(of), up{1, 1, of.dimensions == 2 ? 0 : 1}, walls(sides) {}
    // Cells whose parts have all their corners in the window.
    KOKKOS_INLINE_FUNCTION bool has_parts(const int c[3]) const {
        for (int k = 0; k < nodes.dimensions; ++k) {
            if (c[k] + 1 >= nodes.window.hi[k]) return false;
        }
        return true;
    }
    // Cells whose faces and edges have all their parts in the window.
    KOKKOS_INLINE_FUNCTION bool has_places(const int c[3]) const {
        for (int k = 0; k < nodes.dimensions; ++k) {
            if (c[k] <= nodes.window.lo[k]) return false;
        }
        return has_parts(c);
    }
    // 1 or -1 for a node in the plane of a wall whose liquid side the part between fine nodes f and f + 1 is along an axis, 0 for one that
    // is in no wall's, 2 where the part is beyond.
    KOKKOS_INLINE_FUNCTION int inward(int axis, int node, int f) const {
        const double x = nodes.lower[axis] + nodes.width * node;
        for (int side = 2 * axis; side < 2 * axis + 2; ++side) {
            if (!walls.is_wall[side] || !(math::fabs(x - walls.at[side]) < nodes.surface())) continue;
            const int way = side % 2 == 0 ? 1 : -1;
            return (node == f) == (way == 1) ? way : 2;
        }
        return 0;
    }
    // Distance at a corner of the part with lower fine node f: in the plane of a wall that of bodies, linear along the wall's normal from the two
    // nodes before. `flat`: the axis that the part is flat along, whose walls close it; -1: none.
    KOKKOS_INLINE_FUNCTION double solid_beside(const Array<double>& solid, const int corner[3], const int f[3], int flat) const {
        const double here = solid(nodes.index(corner[0], corner[1], corner[2]));
        if (!(math::fabs(here) < nodes.surface())) return here;
        int first[3] = {corner[0], corner[1], corner[2]}, second[3] = {corner[0], corner[1], corner[2]};
        bool moved = false;
        for (int k = 0; k < nodes.dimensions; ++k) {
            const int way = inward(k, corner[k], f[k]);
            if (way == 2 || (way != 0 && k == flat)) return here;
            first[k] += way;
            second[k] += 2 * way;
            if (second[k] < 2 * nodes.window.lo[k] || second[k] >= 2 * nodes.window.hi[k]) return here;
            moved = moved || way != 0;
        }
        if (!moved) return here;
        return math::max(here, 2 * solid(nodes.index(first[0], first[1], first[2])) - solid(nodes.index(second[0], second[1], second[2])));
    }
    // The corners, x + 2 y + 4 z, of the cube with lower fine node f and edges of `step` fine nodes: use(number, fine node).
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_corner(const int f[3], int step, const Use& use) const {
        for (int k = 0; k < 8; ++k) {
            const int corner[3] = {f[0] + step * (k & 1), f[1] + step * (k >> 1 & 1), up[2] ? f[2] + step * (k >> 2) : 0};
            use(k, corner);
        }
    }
    KOKKOS_INLINE_FUNCTION void solid_corners(const Array<double>& solid, const int f[3], double out[8]) const {
        each_corner(f, 1, [&](int k, const int corner[3]) { out[k] = solid_beside(solid, corner, f, -1); });
    }
    KOKKOS_INLINE_FUNCTION void corners(const Array<double>& values, const int f[3], int step, double out[8]) const {
        each_corner(f, step, [&](int k, const int corner[3]) { out[k] = values(nodes.index(corner[0], corner[1], corner[2])); });
    }
};

// The diagonal of the part at fine cell f starts at the middle of its cell: mirror images all around.
KOKKOS_INLINE_FUNCTION int diagonal_start(const int f[3]) { return (~f[0] & 1) + 2 * (~f[1] & 1) + 4 * (~f[2] & 1); }

// Signs at a cell's own nodes: bits 0 and 1: some in, some out of the solid; bits 2 and 3: of the liquid.
void find_signs(const FineNodes& nodes, const Array<double>& solid, const Array<double>& liquid, const Array<int>& signs) {
    const int used = nodes.used();
    Kokkos::parallel_for("treacle::fraction_signs", static_cast<int>(nodes.window.size()), KOKKOS_LAMBDA(int i) {
        int bits = 0;
        for (int k = 0; k < used; ++k) {
            bits |= solid(FineNodes::per_cell * i + k) < 0 ? 1 : 2;
            bits |= liquid(FineNodes::per_cell * i + k) < 0 ? 4 : 8;
        }
        signs(i) = bits;
    });
}

// Of the cells that are of one kind the kind, of the others a row of the parts. Returns how many rows there are.
std::size_t find_kinds(const Places& places, const Array<int>& signs, const Array<int>& slot) {
    int mixed = 0;
    const CellBox window = places.nodes.window;
    Kokkos::parallel_scan("treacle::fraction_kinds", static_cast<int>(window.size()),
        KOKKOS_LAMBDA(int i, int& row, bool last) {
            int c[3];
            window.cell(i, c);
            int bits = 0;
            if (places.has_parts(c)) {
                for (int z = 0; z <= places.up[2]; ++z) {
                    for (int y = 0; y < 2; ++y) {
                        for (int x = 0; x < 2; ++x) bits |= signs(window.index(c[0] + x, c[1] + y, c[2] + z));
                    }
                }
            } else {
                bits = 2 | 8;
            }
            const bool cut = (bits & 3) == 3 || (bits & 12) == 12;
            if (last) slot(i) = cut ? row : kind_of((bits & 4) != 0, (bits & 1) != 0);
            row += cut ? 1 : 0;
        }, mixed);
    return static_cast<std::size_t>(mixed);
}

KOKKOS_INLINE_FUNCTION CubeShares sample_middle(const double solid[8], const double liquid[8]) {
    double s = 0, l = 0;
    for (int k = 0; k < 8; ++k) {
        s += solid[k];
        l += liquid[k];
    }
    const double fluid = s < 0 ? 0 : 1, inside = l < 0 ? 1 : 0;
    return {fluid, inside, fluid * inside};
}

void clip_parts(const Places& places, const Array<double>& solid, const Array<double>& liquid, bool sample,
                const Array<int>& slot, const Array<double>& parts) {
    const CellBox window = places.nodes.window;
    const int used = places.nodes.used();
    Kokkos::parallel_for("treacle::clip_parts", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
        if (slot(i) < 0) return;
        int c[3];
        window.cell(i, c);
        for (int p = 0; p < used; ++p) {
            const int f[3] = {2 * c[0] + (p & 1), 2 * c[1] + (p >> 1 & 1), places.up[2] ? 2 * c[2] + (p >> 2) : 0};
            double s[8], l[8];
            places.solid_corners(solid, f, s);
            places.corners(liquid, f, 1, l);
            const CubeShares shares = sample ? sample_middle(s, l) : cube_shares(s, l, diagonal_start(f));
            double* row = &parts(24 * std::int64_t(slot(i)) + 3 * p);
            row[0] = shares.fluid;
            row[1] = shares.liquid;
            row[2] = shares.wet;
        }
    });
}

// Which of the cells around a place the part belongs to, and which part it is: places in the middle of a cell along an
// axis have both halves of it, others the upper half of the cell below and the lower half of their own.
struct PartSum {
    Places places;
    Array<int> slot;
    Array<double> parts;

    // `node`: bit k: the place is at the lower end of its cell along axis k.
    KOKKOS_INLINE_FUNCTION CubeShares at(const int c[3], int node) const {
        CubeShares sum;
        const int used = places.nodes.used();
        for (int p = 0; p < used; ++p) {
            // Part p counted from the lower end of the cube of the place.
            int q[3], own = 0;
            for (int k = 0; k < 3; ++k) {
                const int below = (node >> k & 1) & ~(p >> k) & 1;
                q[k] = c[k] - below;
                own |= ((p >> k ^ node >> k) & 1) << k;
            }
            const int row = slot(places.nodes.window.index(q[0], q[1], q[2]));
            if (row < 0) {
                const CubeShares whole = shares_of(row);
                sum.fluid += whole.fluid;
                sum.liquid += whole.liquid;
                sum.wet += whole.wet;
            } else {
                const double* part = &parts(24 * std::int64_t(row) + 3 * own);
                sum.fluid += part[0];
                sum.liquid += part[1];
                sum.wet += part[2];
            }
        }
        return {sum.fluid / used, sum.liquid / used, sum.wet / used};
    }
    // The kind of all cells that the places of cell c take part of, or cut_place.
    KOKKOS_INLINE_FUNCTION int kind(const int c[3]) const {
        const int first = slot(places.nodes.window.index(c[0], c[1], c[2]));
        if (first >= 0) return cut_place;
        for (int z = -places.up[2]; z <= 0; ++z) {
            for (int y = -1; y <= 0; ++y) {
                for (int x = -1; x <= 0; ++x) {
                    if (slot(places.nodes.window.index(c[0] + x, c[1] + y, c[2] + z)) != first) return cut_place;
                }
            }
        }
        return first;
    }
};

// Bit k of a place: at the lower end of its cell along axis k.
KOKKOS_INLINE_FUNCTION int face_place(int axis) { return 1 << axis; }
KOKKOS_INLINE_FUNCTION int edge_place(int axis, int dimensions) { return (dimensions == 2 ? 3 : 7) & ~(1 << axis); }

// Share of the area of the lower face of cell c across an axis that is open, from its four parts. A part that lies in
// the surface of a solid, but for round-off, is closed: one side of it is solid.
KOKKOS_INLINE_FUNCTION double open_share(const Places& places, const Array<double>& solid, int axis, const int c[3]) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double sum = 0;
    int count = 0;
    for (int j = 0; j <= places.up[v]; ++j) {
        for (int i = 0; i <= places.up[u]; ++i, ++count) {
            double s[4];
            bool in_surface = true;
            for (int k = 0; k < 4; ++k) {
                int f[3] = {2 * c[0], 2 * c[1], 2 * c[2]};
                f[u] += i;
                f[v] += j;
                int corner[3] = {f[0], f[1], f[2]};
                corner[u] += k & 1;
                corner[v] += k >> 1;
                if (!places.up[2]) f[2] = corner[2] = 0;
                s[k] = places.solid_beside(solid, corner, f, axis);
                in_surface = in_surface && math::fabs(s[k]) < places.nodes.surface();
            }
            if (!in_surface) sum += square_open_share(s, (1 - i) + 2 * (1 - j));
        }
    }
    return sum / count;
}

// Where the shares of one cell's places go.
struct Writer {
    Fractions out;
    int dimensions;

    KOKKOS_INLINE_FUNCTION void cell(int i, const CubeShares& s) const {
        out.cell_fluid(i) = s.fluid;
        out.cell_liquid(i) = s.liquid;
        out.cell_wet(i) = s.wet;
    }
    KOKKOS_INLINE_FUNCTION void face(int axis, int i, const CubeShares& s) const {
        out.face_fluid.axis[axis](i) = s.fluid;
        out.face_liquid.axis[axis](i) = s.liquid;
        out.face_wet.axis[axis](i) = s.wet;
    }
    KOKKOS_INLINE_FUNCTION void edge(int axis, int i, const CubeShares& s) const {
        out.edge_fluid.axis[axis](i) = s.fluid;
        out.edge_liquid.axis[axis](i) = s.liquid;
        out.edge_wet.axis[axis](i) = s.wet;
    }
    KOKKOS_INLINE_FUNCTION bool has_edge(int axis) const { return dimensions == 3 || axis == 2; }
    KOKKOS_INLINE_FUNCTION void all(int i, const CubeShares& s) const {
        cell(i, s);
        for (int a = 0; a < dimensions; ++a) {
            face(a, i, s);
            out.open.axis[a](i) = s.fluid;
        }
        for (int a = 0; a < 3; ++a) {
            if (has_edge(a)) edge(a, i, s);
        }
    }
};

// Writes the places of each cell; what is of one kind and was so before stays.
void sum_parts(const PartSum& parts, const Array<double>& solid, const Writer& writer, const Array<int>& written) {
    const CellBox window = parts.places.nodes.window;
    Kokkos::parallel_for("treacle::sum_parts", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
        int c[3];
        window.cell(i, c);
        const int kind = parts.places.has_places(c) ? parts.kind(c) : empty_kind;
        if (kind != cut_place) {
            if (written(i) == kind) return;
            writer.all(i, shares_of(kind));
        } else {
            writer.cell(i, parts.at(c, 0));
            for (int a = 0; a < writer.dimensions; ++a) {
                writer.face(a, i, parts.at(c, face_place(a)));
                writer.out.open.axis[a](i) = open_share(parts.places, solid, a, c);
            }
            for (int a = 0; a < 3; ++a) {
                if (writer.has_edge(a)) writer.edge(a, i, parts.at(c, edge_place(a, writer.dimensions)));
            }
        }
        written(i) = kind;
    });
}

// The cube of the place at the lower ends `node` of cell c, by its own corners alone.
KOKKOS_INLINE_FUNCTION CubeShares own_corners(const Places& places, const Array<double>& solid,
                                              const Array<double>& liquid, const int c[3], int node) {
    int f[3];
    for (int k = 0; k < 3; ++k) f[k] = 2 * c[k] - (node >> k & 1);
    double s[8], l[8];
    places.corners(solid, f, 2, s);
    places.corners(liquid, f, 2, l);
    return cube_shares(s, l, 0);
}

void fill_independent(const Places& places, const Array<double>& solid, const Array<double>& liquid, const Writer& writer) {
    const CellBox window = places.nodes.window;
    Kokkos::parallel_for("treacle::independent_fractions", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
        int c[3];
        window.cell(i, c);
        if (!places.has_places(c)) {
            writer.all(i, shares_of(empty_kind));
            return;
        }
        writer.cell(i, own_corners(places, solid, liquid, c, 0));
        for (int a = 0; a < writer.dimensions; ++a) {
            writer.face(a, i, own_corners(places, solid, liquid, c, face_place(a)));
            writer.out.open.axis[a](i) = open_share(places, solid, a, c);
        }
        for (int a = 0; a < 3; ++a) {
            if (writer.has_edge(a)) writer.edge(a, i, own_corners(places, solid, liquid, c, edge_place(a, writer.dimensions)));
        }
    });
}

void reserve_fractions(Fractions& out, int dimensions, std::size_t n) {
    for (auto* cell : {&out.cell_fluid, &out.cell_liquid, &out.cell_wet}) reserve(*cell, n);
    for (auto* face : {&out.face_fluid, &out.face_liquid, &out.face_wet, &out.open}) {
        for (int a = 0; a < dimensions; ++a) reserve(face->axis[a], n);
    }
    for (auto* edge : {&out.edge_fluid, &out.edge_liquid, &out.edge_wet}) {
        for (int a = dimensions == 2 ? 2 : 0; a < 3; ++a) reserve(edge->axis[a], n);
    }
}
} // namespace

void FractionBuilder::build(const FineNodes& nodes, const Array<double>& solid, const Array<double>& liquid,
                            FractionMethod method, Fractions& out, const WallPlanes& walls) {
    const auto n = static_cast<std::size_t>(nodes.window.size());
    reserve_fractions(out, nodes.dimensions, n);
    const Places places(nodes, walls);
    const Writer writer{out, nodes.dimensions};
    reserve(slot_, n);
    reserve(written_, n);
    const bool same = same_cells(filled_, nodes.window) && filled_data_ == out.cell_fluid.data();
    if (!same) Kokkos::deep_copy(written_, unknown_place);
    reserve(signs_, n);
    find_signs(nodes, solid, liquid, signs_);
    mixed_ = find_kinds(places, signs_, slot_);
    reserve(parts_, 24 * mixed_);
    clip_parts(places, solid, liquid, method == FractionMethod::supersampled, slot_, parts_);
    if (method == FractionMethod::independent) {
        fill_independent(places, solid, liquid, writer);
        Kokkos::deep_copy(written_, unknown_place);
    } else {
        sum_parts({places, slot_, parts_}, solid, writer, written_);
    }
    filled_ = nodes.window;
    filled_data_ = out.cell_fluid.data();
}

namespace {
// Shares of the solids in the cube around a face, at most `most` of them; what is beyond goes to the last.
struct FewShares {
    static constexpr int most = 8;
    int body[most];
    double share[most];
    int count = 0;

    KOKKOS_INLINE_FUNCTION void add(int which, double value) {
        int k = 0;
        while (k < count && body[k] != which) ++k;
        if (k == most) k = most - 1;
        if (k == count) {
            body[count] = which;
            share[count++] = 0;
        }
        share[k] += value;
    }
};

// The parts of the cube around a face that are of bodies that move. A solid part belongs to the solids nearest to its
// corners, by how deep those lie.
KOKKOS_INLINE_FUNCTION void find_shares(const PartSum& parts, const Array<double>& solid, const Array<int>& number,
                                        const Array<int>& moves, int axis, const int c[3], FewShares& out) {
    const Places& places = parts.places;
    const int used = places.nodes.used(), node = face_place(axis);
    for (int p = 0; p < used; ++p) {
        int q[3], f[3], own = 0;
        for (int k = 0; k < 3; ++k) {
            q[k] = c[k] - ((node >> k & 1) & ~(p >> k) & 1);
            own |= ((p >> k ^ node >> k) & 1) << k;
        }
        for (int k = 0; k < 3; ++k) f[k] = 2 * q[k] + (own >> k & 1);
        if (!places.up[2]) f[2] = 0;
        const int row = parts.slot(places.nodes.window.index(q[0], q[1], q[2]));
        const double volume = (1 - (row < 0 ? shares_of(row).fluid : parts.parts(24 * std::int64_t(row) + 3 * own))) / used;
        if (volume <= 0) continue;
        double total = 0;
        for (int pass = 0; pass < 2; ++pass) {
            for (int k = 0; k < 8; ++k) {
                const int z = places.up[2] ? f[2] + (k >> 2) : 0;
                const int at = places.nodes.index(f[0] + (k & 1), f[1] + (k >> 1 & 1), z);
                const double depth = -solid(at);
                if (depth <= 0) continue;
                if (pass == 0) total += depth;
                else if (number(at) >= 0 && moves(number(at))) out.add(number(at), volume * depth / total);
            }
        }
    }
}

void count_shares(const PartSum& parts, const Array<double>& solid, const Array<int>& number, const Array<int>& moves,
                  int axis, const Array<int>& first) {
    const CellBox window = parts.places.nodes.window;
    Kokkos::parallel_for("treacle::count_body_shares", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
        int c[3];
        window.cell(i, c);
        FewShares found;
        if (parts.places.has_places(c)) {
            const int kind = parts.kind(c);
            if (kind == cut_place || shares_of(kind).fluid == 0) find_shares(parts, solid, number, moves, axis, c, found);
        }
        first(i) = found.count;
    });
}

void write_shares(const PartSum& parts, const Array<double>& solid, const Array<int>& number, const Array<int>& moves,
                  int axis, const BodyShares& out) {
    const CellBox window = parts.places.nodes.window;
    Kokkos::parallel_for("treacle::write_body_shares", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
        const int begin = out.first(i), end = out.first(i + 1);
        if (begin == end) return;
        int c[3];
        window.cell(i, c);
        FewShares found;
        find_shares(parts, solid, number, moves, axis, c, found);
        for (int k = begin; k < end; ++k) {
            out.body(k) = found.body[k - begin];
            out.share(k) = found.share[k - begin];
        }
    });
}
} // namespace

void FractionBuilder::build_body_shares(const FineNodes& nodes, const Array<double>& solid, const Array<int>& number,
                                        const Array<int>& moves, BodyShares shares[3]) const {
    const auto n = static_cast<std::size_t>(nodes.window.size());
    const PartSum parts{Places(nodes, {}), slot_, parts_};
    for (int a = 0; a < nodes.dimensions; ++a) {
        reserve(shares[a].first, n + 1);
        count_shares(parts, solid, number, moves, a, shares[a].first);
        const auto entries = static_cast<std::size_t>(counts_to_offsets(shares[a].first, static_cast<int>(n)));
        reserve(shares[a].body, entries);
        reserve(shares[a].share, entries);
        write_shares(parts, solid, number, moves, a, shares[a]);
    }
}

} // namespace treacle::grid
