#include "grid/geometry/fractions.hpp"

#include "grid/geometry/face_cut.hpp"
#include "grid/geometry/fraction_parts.hpp"
#include "grid/mac/polyhedron.hpp"
#include "kokkos/scan.hpp"

namespace treacle::grid {

namespace {
// The diagonal of the part at fine cell f starts at the middle of its cell: mirror images all around.
KOKKOS_INLINE_FUNCTION int diagonal_start(const int f[3]) { return (~f[0] & 1) + 2 * (~f[1] & 1) + 4 * (~f[2] & 1); }

// Signs at a cell's own nodes: bits 0 and 1: some in, some out of the solid; bits 2 and 3: of the liquid.
void find_signs(
    const FineNodes& nodes, const Array<double>& solid, const Array<double>& liquid, const Array<int>& signs) {
    const int used = nodes.used();
    Kokkos::parallel_for(
        "treacle::fraction_signs", static_cast<int>(nodes.window.size()), KOKKOS_LAMBDA(int i) {
            int bits = 0;
            for (int k = 0; k < used; ++k) {
                bits |= solid(FineNodes::per_cell * i + k) < 0 ? 1 : 2;
                bits |= liquid(FineNodes::per_cell * i + k) < 0 ? 4 : 8;
            }
            signs(i) = bits;
        });
}

// Slots of the cells: for those of one kind the kind, for the others a row of the parts. Returns the number of rows.
std::size_t find_kinds(
    const ControlVolumes& volumes, const Array<int>& signs, const Array<int>& slot, const Array<int>& dry) {
    int mixed = 0;
    const CellBox window = volumes.nodes.window;
    Kokkos::parallel_scan(
        "treacle::fraction_kinds", static_cast<int>(window.size()),
        KOKKOS_LAMBDA(int i, int& row, bool last) {
            int c[3];
            window.cell(i, c);
            int bits = 0;
            if (volumes.has_parts(c)) {
                for (int z = 0; z <= volumes.up[2]; ++z) {
                    for (int y = 0; y < 2; ++y) {
                        for (int x = 0; x < 2; ++x) bits |= signs(window.index(c[0] + x, c[1] + y, c[2] + z));
                    }
                }
            } else {
                bits = 2 | 8;
            }
            const bool cut = (bits & 3) == 3 || (bits & 12) == 12;
            if (last) {
                slot(i) = cut ? row : kind_of((bits & 4) != 0, (bits & 1) != 0);
                dry(i) = bits & 4 ? 0 : 1;
            }
            row += cut ? 1 : 0;
        },
        mixed);
    return static_cast<std::size_t>(mixed);
}

KOKKOS_INLINE_FUNCTION CubeFractions sample_middle(const double solid[8], const double liquid[8]) {
    double s = 0, l = 0;
    for (int k = 0; k < 8; ++k) {
        s += solid[k];
        l += liquid[k];
    }
    const double fluid = s < 0 ? 0 : 1, inside = l < 0 ? 1 : 0;
    return {fluid, inside, fluid * inside};
}

void clip_parts(const PartSum& to, const Array<double>& solid, const Array<double>& liquid, FractionMethod method) {
    const ControlVolumes volumes = to.volumes;
    const CellBox window = volumes.nodes.window;
    const int used = volumes.nodes.used();
    const bool sample = method == FractionMethod::supersampled;
    Kokkos::parallel_for(
        "treacle::clip_parts", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
            if (to.slot(i) < 0) return;
            int c[3];
            window.cell(i, c);
            for (int p = 0; p < used; ++p) {
                const int f[3] = {2 * c[0] + (p & 1), 2 * c[1] + (p >> 1 & 1), volumes.up[2] ? 2 * c[2] + (p >> 2) : 0};
                double s[8], l[8];
                volumes.solid_corners(solid, f, s);
                volumes.corners(liquid, f, 1, l);
                const CubeFractions cube = sample ? sample_middle(s, l) : cube_fractions(s, l, diagonal_start(f));
                double* row = &to.parts(24 * std::int64_t(to.slot(i)) + 3 * p);
                row[0] = cube.fluid;
                row[1] = cube.liquid;
                row[2] = cube.wet;
            }
        });
}

// Bit k of a node: its cube is at the lower end of its cell along axis k.
KOKKOS_INLINE_FUNCTION int edge_node(int axis, int dimensions) { return (dimensions == 2 ? 3 : 7) & ~(1 << axis); }

// Fraction of the area of the lower face of cell c across an axis that is open, from its four parts. A part that lies in
// the surface of a solid, but for round-off, is closed: one side of it is solid.
KOKKOS_INLINE_FUNCTION double open_fraction(
    const ControlVolumes& volumes, const Array<double>& solid, int axis, const int c[3]) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const SolidBends bends{volumes.nodes, solid};
    double sum = 0;
    int count = 0;
    for (int j = 0; j <= volumes.up[v]; ++j) {
        for (int i = 0; i <= volumes.up[u]; ++i, ++count) {
            FaceSquare square;
            bool in_surface = true;
            square.set_nodes(volumes.nodes.dimensions, axis, c, i, j);
            for (int k = 0; k < 4; ++k) {
                square.distance[k] = volumes.solid_beside(solid, square.node[k], square.node[0], axis);
                in_surface = in_surface && math::fabs(square.distance[k]) < volumes.nodes.surface();
            }
            if (!in_surface)
                sum += 1 - math::max(0.0, math::min(1.0, square.closed(bends, (1 - i) + 2 * (1 - j)).area));
        }
    }
    return sum / count;
}

// Destination of the shares of one cell's places.
struct Writer {
    Fractions out;
    int dimensions;

    KOKKOS_INLINE_FUNCTION void cell(int i, const CubeFractions& s) const {
        out.cell_fluid(i) = s.fluid;
        out.cell_liquid(i) = s.liquid;
        out.cell_liquid_clipped(i) = s.wet;
    }
    KOKKOS_INLINE_FUNCTION void face(int axis, int i, const CubeFractions& s) const {
        out.face_fluid.axis[axis](i) = s.fluid;
        out.face_liquid.axis[axis](i) = s.liquid;
        out.face_liquid_clipped.axis[axis](i) = s.wet;
    }
    KOKKOS_INLINE_FUNCTION void edge(int axis, int i, const CubeFractions& s) const {
        out.edge_fluid.axis[axis](i) = s.fluid;
        out.edge_liquid.axis[axis](i) = s.liquid;
        out.edge_liquid_clipped.axis[axis](i) = s.wet;
    }
    KOKKOS_INLINE_FUNCTION bool has_edge(int axis) const { return dimensions == 3 || axis == 2; }
    KOKKOS_INLINE_FUNCTION void all(int i, const CubeFractions& s) const {
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

// Writes the cubes of each cell; what is of one kind and was so before stays, and with the same solids what has no liquid.
void sum_parts(const PartSum& parts, const Array<double>& solid, bool same_solids, const Writer& writer,
    const Array<int>& written) {
    const CellBox window = parts.volumes.nodes.window;
    Kokkos::parallel_for(
        "treacle::sum_parts", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
            int c[3];
            window.cell(i, c);
            const int kind = parts.volumes.has_volumes(c) ? parts.kind(c) : empty_kind;
            if (kind < 0) {
                if (written(i) == kind) return;
                writer.all(i, fractions_of(kind));
            } else {
                const bool same = same_solids && written(i) >= 0;
                if (same && kind == dry_kind && written(i) == dry_kind) return;
                writer.cell(i, parts.at(c, 0));
                for (int a = 0; a < writer.dimensions; ++a) {
                    writer.face(a, i, parts.at(c, face_node(a)));
                    if (!same) writer.out.open.axis[a](i) = open_fraction(parts.volumes, solid, a, c);
                }
                for (int a = 0; a < 3; ++a) {
                    if (writer.has_edge(a)) writer.edge(a, i, parts.at(c, edge_node(a, writer.dimensions)));
                }
            }
            written(i) = kind;
        });
}

// The cube at the lower ends `node` of cell c, by its own corners alone.
KOKKOS_INLINE_FUNCTION CubeFractions own_corners(
    const ControlVolumes& volumes, const Array<double>& solid, const Array<double>& liquid, const int c[3], int node) {
    int f[3];
    for (int k = 0; k < 3; ++k) f[k] = 2 * c[k] - (node >> k & 1);
    double s[8], l[8];
    volumes.corners(solid, f, 2, s);
    volumes.corners(liquid, f, 2, l);
    return cube_fractions(s, l, 0);
}

void fill_independent(
    const ControlVolumes& volumes, const Array<double>& solid, const Array<double>& liquid, const Writer& writer) {
    const CellBox window = volumes.nodes.window;
    Kokkos::parallel_for(
        "treacle::independent_fractions", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
            int c[3];
            window.cell(i, c);
            if (!volumes.has_volumes(c)) {
                writer.all(i, fractions_of(empty_kind));
                return;
            }
            writer.cell(i, own_corners(volumes, solid, liquid, c, 0));
            for (int a = 0; a < writer.dimensions; ++a) {
                writer.face(a, i, own_corners(volumes, solid, liquid, c, face_node(a)));
                writer.out.open.axis[a](i) = open_fraction(volumes, solid, a, c);
            }
            for (int a = 0; a < 3; ++a) {
                if (writer.has_edge(a))
                    writer.edge(a, i, own_corners(volumes, solid, liquid, c, edge_node(a, writer.dimensions)));
            }
        });
}

void reserve_fractions(Fractions& out, int dimensions, std::size_t n) {
    for (auto* cell : {&out.cell_fluid, &out.cell_liquid, &out.cell_liquid_clipped}) reserve(*cell, n);
    for (auto* face : {&out.face_fluid, &out.face_liquid, &out.face_liquid_clipped, &out.open}) {
        for (int a = 0; a < dimensions; ++a) reserve(face->axis[a], n);
    }
    for (auto* edge : {&out.edge_fluid, &out.edge_liquid, &out.edge_liquid_clipped}) {
        for (int a = dimensions == 2 ? 2 : 0; a < 3; ++a) reserve(edge->axis[a], n);
    }
}
} // namespace

void FractionBuilder::build(const FineNodes& nodes, const Array<double>& solid, const Array<double>& liquid,
    FractionMethod method, Fractions& out, const WallPlanes& walls, std::int64_t changes) {
    const auto n = static_cast<std::size_t>(nodes.window.size());
    reserve_fractions(out, nodes.dimensions, n);
    const ControlVolumes volumes(nodes, walls);
    const Writer writer{out, nodes.dimensions};
    reserve(slot_, n);
    reserve(written_, n);
    const bool same = same_cells(filled_, nodes.window) && filled_data_ == out.cell_fluid.data();
    if (!same) Kokkos::deep_copy(written_, unknown_kind);
    reserve(signs_, n);
    reserve(dry_, n);
    find_signs(nodes, solid, liquid, signs_);
    mixed_ = find_kinds(volumes, signs_, slot_, dry_);
    reserve(parts_, 24 * mixed_);
    const PartSum parts{volumes, slot_, dry_, parts_};
    clip_parts(parts, solid, liquid, method);
    if (method == FractionMethod::independent) {
        fill_independent(volumes, solid, liquid, writer);
        Kokkos::deep_copy(written_, unknown_kind);
    } else {
        sum_parts(parts, solid, changes >= 0 && changes == changes_, writer, written_);
    }
    changes_ = changes;
    filled_ = nodes.window;
    filled_data_ = out.cell_fluid.data();
}

} // namespace treacle::grid
