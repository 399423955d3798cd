#include "grid/geometry/closed_centres.hpp"

#include "grid/geometry/face_cut.hpp"

namespace treacle::grid {

namespace {
// Bits of a cell: not all of its nodes are far inside, not all far outside of the solids.
constexpr int not_inside = 1, not_outside = 2;

// Sides of the solids' surface that the nodes of each cell are on.
void find_sides(const SolidBends& bends, const Array<int>& sides) {
    const FineNodes nodes = bends.nodes;
    const double far = bends.most_bend();
    Kokkos::parallel_for(
        "treacle::sides_of_solids", static_cast<int>(nodes.window.size()), KOKKOS_LAMBDA(int i) {
            int bits = 0;
            for (int k = 0; k < nodes.used(); ++k) {
                const double d = bends.solid(FineNodes::per_cell * i + k);
                bits |= (d < -far ? 0 : not_inside) | (d > far ? 0 : not_outside);
            }
            sides(i) = bits;
        });
}

struct CentreLoop {
    FineNodes nodes;
    Array<double> solid;
    Array<int> sides;
    int axis;
    Array<double> out[2];

    // True where the surface may pass through the face.
    KOKKOS_INLINE_FUNCTION bool may_be_cut(const int c[3], int u, int v, const int parts[2]) const {
        int bits = 0;
        for (int j = 0; j <= parts[1]; ++j) {
            for (int i = 0; i <= parts[0]; ++i) {
                int q[3] = {c[0], c[1], c[2]};
                q[u] += i;
                q[v] += j;
                bits |= sides(static_cast<int>(nodes.window.index(q[0], q[1], q[2])));
            }
        }
        return bits == (not_inside | not_outside);
    }

    KOKKOS_INLINE_FUNCTION void operator()(int at) const {
        int c[3];
        nodes.window.cell(at, c);
        out[0](at) = out[1](at) = 0;
        for (int k = 0; k < nodes.dimensions; ++k) {
            if (c[k] + 1 >= nodes.window.hi[k]) return;
        }
        const int u = (axis + 1) % 3, v = (axis + 2) % 3, up = nodes.dimensions == 2 ? 0 : 1;
        const int parts[2] = {u == 2 ? up : 1, v == 2 ? up : 1};
        if (!may_be_cut(c, u, v, parts)) return;
        const SolidBends bends{nodes, solid};
        SquarePart sum;
        for (int j = 0; j <= parts[1]; ++j) {
            for (int i = 0; i <= parts[0]; ++i) {
                FaceSquare square;
                square.set_nodes(nodes.dimensions, axis, c, i, j);
                for (int k = 0; k < 4; ++k) {
                    const int* f = square.node[k];
                    square.distance[k] = solid(nodes.index(f[0], f[1], f[2]));
                }
                const auto part = square.closed(bends, (1 - i) + 2 * (1 - j));
                sum.area += part.area;
                sum.x += part.x + i * part.area;
                sum.y += part.y + j * part.area;
            }
        }
        if (!(sum.area > 0)) return;
        if (parts[0] == 1) out[0](at) = 0.5 * sum.x / sum.area - 0.5;
        if (parts[1] == 1) out[1](at) = 0.5 * sum.y / sum.area - 0.5;
    }
};
} // namespace

void ClosedCentres::find(const Solids& solids) {
    if (solids.changes() == changes_) return;
    find(solids.nodes(), solids.distance());
    changes_ = solids.changes();
}

void ClosedCentres::find(const FineNodes& nodes, const Array<double>& solid) {
    changes_ = -1;
    const auto n = static_cast<std::size_t>(nodes.window.size());
    reserve(sides_, n);
    find_sides({nodes, solid}, sides_);
    for (int a = 0; a < nodes.dimensions; ++a) {
        for (auto& component : offset_[a]) reserve(component, n);
        Kokkos::parallel_for("treacle::closed_centres", static_cast<int>(n),
            CentreLoop{nodes, solid, sides_, a, {offset_[a][0], offset_[a][1]}});
    }
}

std::size_t ClosedCentres::bytes() const {
    std::size_t numbers = 0;
    for (const auto& axis : offset_) {
        for (const auto& component : axis) numbers += component.span();
    }
    return sizeof(double) * numbers + sizeof(int) * sides_.span();
}

} // namespace treacle::grid
