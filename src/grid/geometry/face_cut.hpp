#pragma once
#include "grid/mac/fine_nodes.hpp"
#include "grid/mac/polyhedron.hpp"

// Parts of faces on the solid's side of its surface. A face is cut between fine nodes, each square of them as two triangles.
namespace treacle::grid {

// Crossings of the solid's surface with the lines between fine nodes.
struct SolidCrossings {
    FineNodes nodes;
    Array<double> solid; // distances at the fine nodes [m]

    KOKKOS_INLINE_FUNCTION bool in_window(const int f[3]) const {
        for (int k = 0; k < nodes.dimensions; ++k) {
            if (f[k] < 2 * nodes.window.lo[k] || f[k] >= 2 * nodes.window.hi[k]) return false;
        }
        return true;
    }
    // Second difference of the distance along the line through the fine nodes a and b with distances da, db: the harmonic mean of those at a
    // and at b, as van Leer limits slopes; 0 at kinks, on walls and at the window's border.
    KOKKOS_INLINE_FUNCTION double bend(const int a[3], const int b[3], double da, double db) const {
        const int before[3] = {2 * a[0] - b[0], 2 * a[1] - b[1], 2 * a[2] - b[2]};
        const int after[3] = {2 * b[0] - a[0], 2 * b[1] - a[1], 2 * b[2] - a[2]};
        if (!in_window(before) || !in_window(after)) return 0;
        const bool as_stored = da == solid(nodes.index(a[0], a[1], a[2])) && db == solid(nodes.index(b[0], b[1], b[2]));
        if (!as_stored) return 0;
        const double at_a = solid(nodes.index(before[0], before[1], before[2])) - 2 * da + db;
        const double at_b = da - 2 * db + solid(nodes.index(after[0], after[1], after[2]));
        return at_a * at_b > 0 ? 2 * at_a * at_b / (at_a + at_b) : 0;
    }
    // Fraction of the line from node a to node b, whose distances differ in sign, that lies on a's side. A surface bends away from the zero of a
    // straight line by h^2 / 8 R, which for a body that turns along itself is a flow across its surface.
    KOKKOS_INLINE_FUNCTION double operator()(const int a[3], const int b[3], double da, double db) const {
        const double rise = db - da, most = math::fabs(rise);
        const double bent = math::max(-most, math::min(most, bend(a, b, da, db)));
        // The zero of da + rise t - bent t (1 - t) / 2 between 0 and 1.
        const double slope = rise - 0.5 * bent;
        const double root = math::sqrt(math::max(0.0, slope * slope - 2 * bent * da));
        return math::max(0.0, math::min(1.0, -2 * da / (slope + (slope < 0 ? -root : root))));
    }
};

// Area and first moments about corner 0 of a part of a unit square.
struct SquarePart {
    double area = 0, x = 0, y = 0;

    KOKKOS_INLINE_FUNCTION void add(double sign, const double a[2], const double b[2], const double c[2]) {
        const double size = 0.5 * math::fabs((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])) * sign;
        area += size;
        x += size * (a[0] + b[0] + c[0]) / 3;
        y += size * (a[1] + b[1] + c[1]) / 3;
    }
};

// A square between four fine nodes with their distances, numbered x + 2 y along the face's axes.
struct FaceSquare {
    int node[4][3];
    double distance[4];

    // The part where the distance is negative; two triangles on either side of the diagonal from corner `start`.
    KOKKOS_INLINE_FUNCTION SquarePart closed(const SolidCrossings& crossing, int start) const {
        SquarePart sum;
        for (int t = 1; t <= 2; ++t) {
            const int corner[3] = {start, t ^ start, 3 ^ start};
            add_negative(crossing, corner, sum);
        }
        return sum;
    }

private:
    KOKKOS_INLINE_FUNCTION void corner_position(int corner, double out[2]) const {
        out[0] = corner & 1;
        out[1] = corner >> 1;
    }
    KOKKOS_INLINE_FUNCTION double fraction(const SolidCrossings& crossing, int from, int to) const {
        return crossing(node[from], node[to], distance[from], distance[to]);
    }
    KOKKOS_INLINE_FUNCTION void on_edge(int from, int to, double fraction, double out[2]) const {
        double a[2], b[2];
        corner_position(from, a);
        corner_position(to, b);
        for (int k = 0; k < 2; ++k) out[k] = a[k] + fraction * (b[k] - a[k]);
    }
    KOKKOS_INLINE_FUNCTION void add_negative(
        const SolidCrossings& crossing, const int corner[3], SquarePart& sum) const {
        const double at[3] = {distance[corner[0]], distance[corner[1]], distance[corner[2]]};
        int o[3];
        const int negative = order_by_sign<3>(at, o);
        if (negative == 0) return;
        double a[2], b[2], c[2];
        if (negative > 1) {
            corner_position(corner[0], a);
            corner_position(corner[1], b);
            corner_position(corner[2], c);
            sum.add(1, a, b, c);
        }
        if (negative == 3) return;
        const int alone = corner[negative == 1 ? o[0] : o[2]], first = corner[negative == 1 ? o[1] : o[0]],
                  second = corner[negative == 1 ? o[2] : o[1]];
        corner_position(alone, a);
        on_edge(alone, first, fraction(crossing, alone, first), b);
        on_edge(alone, second, fraction(crossing, alone, second), c);
        sum.add(negative == 1 ? 1 : -1, a, b, c);
    }
};

} // namespace treacle::grid
