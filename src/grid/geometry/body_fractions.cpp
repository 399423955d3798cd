#include "grid/geometry/fraction_parts.hpp"
#include "kokkos/scan.hpp"

namespace treacle::grid {

namespace {
// Fractions of the solids in the cube around a face, at most `most` of them; what is beyond goes to the last.
struct BodyList {
    static constexpr int most = 8;
    int body[most];
    double fraction[most];
    int count = 0;

    KOKKOS_INLINE_FUNCTION void add(int which, double value) {
        int k = 0;
        while (k < count && body[k] != which) ++k;
        if (k == most) k = most - 1;
        if (k == count) {
            body[count] = which;
            fraction[count++] = 0;
        }
        fraction[k] += value;
    }
};

// Distances [fine nodes] from the solids [m], the numbers of these, and which of them move.
struct NodeSolids {
    Array<double> distance;
    Array<int> number, moves;
};

// The parts of the cube around a face that are of bodies that move. A solid part belongs to the solids nearest to its
// corners, by how deep those lie.
KOKKOS_INLINE_FUNCTION void find_body_fractions(
    const PartSum& parts, const NodeSolids& solids, int axis, const int c[3], BodyList& out) {
    const ControlVolumes& volumes = parts.volumes;
    const int used = volumes.nodes.used(), node = face_node(axis);
    for (int p = 0; p < used; ++p) {
        int q[3], f[3], own = 0;
        for (int k = 0; k < 3; ++k) {
            q[k] = c[k] - ((node >> k & 1) & ~(p >> k) & 1);
            own |= ((p >> k ^ node >> k) & 1) << k;
        }
        for (int k = 0; k < 3; ++k) f[k] = 2 * q[k] + (own >> k & 1);
        if (!volumes.up[2]) f[2] = 0;
        const int row = parts.slot(volumes.nodes.window.index(q[0], q[1], q[2]));
        const double volume =
            (1 - (row < 0 ? fractions_of(row).fluid : parts.parts(24 * std::int64_t(row) + 3 * own))) / used;
        if (volume <= 0) continue;
        double depth[8], total = 0;
        int number[8];
        volumes.each_corner(f, 1, [&](int k, const int corner[3]) {
            const int at = volumes.nodes.index(corner[0], corner[1], corner[2]);
            depth[k] = math::max(0.0, -solids.distance(at));
            number[k] = solids.number(at);
            total += depth[k];
        });
        for (int k = 0; k < 8; ++k) {
            if (depth[k] > 0 && number[k] >= 0 && solids.moves(number[k]))
                out.add(number[k], volume * depth[k] / total);
        }
    }
}

// Marks the cells that have nodes in bodies that move.
void mark_cells(const FineNodes& nodes, const NodeSolids& solids, const Array<int>& marked) {
    const int used = nodes.used();
    Kokkos::parallel_for(
        "treacle::cells_of_bodies", static_cast<int>(nodes.window.size()), KOKKOS_LAMBDA(int i) {
            bool any = false;
            for (int at = FineNodes::per_cell * i; at < FineNodes::per_cell * i + used; ++at) {
                any = any || (solids.distance(at) < 0 && solids.number(at) >= 0 && solids.moves(solids.number(at)));
            }
            marked(i) = any ? 1 : 0;
        });
}

// True where the cube around the lower face of cell c across an axis has nodes of marked cells.
KOKKOS_INLINE_FUNCTION bool any_marked(
    const ControlVolumes& volumes, const Array<int>& marked, int axis, const int c[3]) {
    const int from[3] = {c[0] - (axis == 0), c[1] - (axis == 1), c[2] - (axis == 2)};
    for (int z = from[2]; z <= c[2] + volumes.up[2]; ++z) {
        for (int y = from[1]; y <= c[1] + 1; ++y) {
            for (int x = from[0]; x <= c[0] + 1; ++x) {
                if (marked(volumes.nodes.window.index(x, y, z)) != 0) return true;
            }
        }
    }
    return false;
}

void count_body_fractions(
    const PartSum& parts, const NodeSolids& solids, const Array<int>& marked, int axis, const Array<int>& first) {
    const CellBox window = parts.volumes.nodes.window;
    Kokkos::parallel_for(
        "treacle::count_body_fractions", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
            int c[3];
            window.cell(i, c);
            BodyList found;
            if (parts.volumes.has_volumes(c) && any_marked(parts.volumes, marked, axis, c)) {
                const int kind = parts.kind(c);
                if (kind >= 0 || fractions_of(kind).fluid == 0) find_body_fractions(parts, solids, axis, c, found);
            }
            first(i) = found.count;
        });
}

void write_body_fractions(const PartSum& parts, const NodeSolids& solids, int axis, const BodyFractions& out) {
    const CellBox window = parts.volumes.nodes.window;
    Kokkos::parallel_for(
        "treacle::write_body_fractions", static_cast<int>(window.size()), KOKKOS_LAMBDA(int i) {
            const int begin = out.first(i), end = out.first(i + 1);
            if (begin == end) return;
            int c[3];
            window.cell(i, c);
            BodyList found;
            find_body_fractions(parts, solids, axis, c, found);
            for (int k = begin; k < end; ++k) {
                out.body(k) = found.body[k - begin];
                out.fraction(k) = found.fraction[k - begin];
            }
        });
}
} // namespace

void FractionBuilder::build_body_fractions(const FineNodes& nodes, const Array<double>& solid, const Array<int>& number,
    const Array<int>& moves, BodyFractions body_fractions[3]) const {
    const auto n = static_cast<std::size_t>(nodes.window.size());
    const PartSum parts{ControlVolumes(nodes, {}), slot_, dry_, parts_};
    const NodeSolids solids{solid, number, moves};
    const auto marked = signs_; // free after build()
    mark_cells(nodes, solids, marked);
    for (int a = 0; a < nodes.dimensions; ++a) {
        reserve(body_fractions[a].first, n + 1);
        count_body_fractions(parts, solids, marked, a, body_fractions[a].first);
        const auto entries = static_cast<std::size_t>(counts_to_offsets(body_fractions[a].first, static_cast<int>(n)));
        reserve(body_fractions[a].body, entries);
        reserve(body_fractions[a].fraction, entries);
        write_body_fractions(parts, solids, a, body_fractions[a]);
    }
}

} // namespace treacle::grid
