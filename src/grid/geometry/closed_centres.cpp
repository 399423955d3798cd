#include "grid/geometry/closed_centres.hpp"

#include "grid/mac/polyhedron.hpp"

namespace treacle::grid {

namespace {
// Area and first moments of a part of a unit square.
struct Moments {
    double area = 0, x = 0, y = 0;

    KOKKOS_INLINE_FUNCTION void add(double sign, const double a[2], const double b[2], const double c[2]) {
        const double size = 0.5 * math::fabs((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) * sign;
        area += size;
        x += size * (a[0] + b[0] + c[0]) / 3;
        y += size * (a[1] + b[1] + c[1]) / 3;
    }
};

KOKKOS_INLINE_FUNCTION void between(const double a[2], const double b[2], double fraction, double out[2]) {
    for (int k = 0; k < 2; ++k) out[k] = a[k] + fraction * (b[k] - a[k]);
}

// Adds the part of a triangle with a negative distance.
KOKKOS_INLINE_FUNCTION void add_negative(const double at[3][2], const double distance[3], Moments& sum) {
    int o[3];
    const int negative = order_by_sign<3>(distance, o);
    if (negative == 0) return;
    if (negative > 1) sum.add(1, at[0], at[1], at[2]);
    if (negative == 3) return;
    const int corner = negative == 1 ? o[0] : o[2], first = negative == 1 ? o[1] : o[0],
              second = negative == 1 ? o[2] : o[1];
    double b[2], c[2];
    between(at[corner], at[first], cut(distance[corner], distance[first]), b);
    between(at[corner], at[second], cut(distance[corner], distance[second]), c);
    sum.add(negative == 1 ? 1 : -1, at[corner], b, c);
}

// As square_open_share cuts it.
KOKKOS_INLINE_FUNCTION Moments closed_part(const double solid[4], int start) {
    Moments out;
    for (int t = 1; t <= 2; ++t) {
        const int corner[3] = {start, t ^ start, 3 ^ start};
        double at[3][2], s[3];
        for (int k = 0; k < 3; ++k) {
            at[k][0] = corner[k] & 1;
            at[k][1] = corner[k] >> 1;
            s[k] = solid[corner[k]];
        }
        add_negative(at, s, out);
    }
    return out;
}

struct CentreLoop {
    FineNodes nodes;
    Array<double> solid;
    int axis;
    Array<double> out[2];

    KOKKOS_INLINE_FUNCTION void operator()(int at) const {
        int c[3];
        nodes.window.cell(at, c);
        out[0](at) = out[1](at) = 0;
        for (int k = 0; k < nodes.dimensions; ++k) {
            if (c[k] + 1 >= nodes.window.hi[k]) return;
        }
        const int u = (axis + 1) % 3, v = (axis + 2) % 3, up = nodes.dimensions == 2 ? 0 : 1;
        const int parts[2] = {u == 2 ? up : 1, v == 2 ? up : 1};
        Moments sum;
        for (int j = 0; j <= parts[1]; ++j) {
            for (int i = 0; i <= parts[0]; ++i) {
                double s[4];
                for (int k = 0; k < 4; ++k) {
                    int f[3] = {2 * c[0], 2 * c[1], 2 * c[2]};
                    f[u] += i + (k & 1);
                    f[v] += j + (k >> 1);
                    if (!up) f[2] = 0;
                    s[k] = solid(nodes.index(f[0], f[1], f[2]));
                }
                const auto part = closed_part(s, (1 - i) + 2 * (1 - j));
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

void ClosedCentres::find(const FineNodes& nodes, const Array<double>& solid) {
    const auto n = static_cast<std::size_t>(nodes.window.size());
    for (int a = 0; a < nodes.dimensions; ++a) {
        for (auto& component : offset_[a]) reserve(component, n);
        Kokkos::parallel_for("treacle::closed_centres", static_cast<int>(n),
            CentreLoop{nodes, solid, a, {offset_[a][0], offset_[a][1]}});
    }
}

std::size_t ClosedCentres::bytes() const {
    std::size_t numbers = 0;
    for (const auto& axis : offset_) {
        for (const auto& component : axis) numbers += component.span();
    }
    return sizeof(double) * numbers;
}

} // namespace treacle::grid
