#pragma once
#include "grid/mac/fine_nodes.hpp"
#include "grid/mac/polyhedron.hpp"

// Parts of faces on the solid's side of its surface. A face is cut between fine nodes, each square of them as two triangles.
namespace treacle::grid {

// Bends of the distance of solids along the lines between fine nodes.
struct SolidBends {
    FineNodes nodes;
    Array<double> solid; // distances at the fine nodes [m]

    // Largest bend of a line in a face [m], that of a diagonal.
    KOKKOS_INLINE_FUNCTION double most_bend() const { return 0.5 * nodes.width; }
    KOKKOS_INLINE_FUNCTION bool in_window(const int f[3]) const {
        for (int k = 0; k < nodes.dimensions; ++k) {
            if (f[k] < 2 * nodes.window.lo[k] || f[k] >= 2 * nodes.window.hi[k]) return false;
        }
        return true;
    }
    // Second difference of the distance along the line through the fine nodes a and b with distances da, db: the harmonic mean of those at a
    // and at b, as van Leer limits slopes; 0 at kinks, which are those of a radius below two cells, on walls and at the window's border.
    KOKKOS_INLINE_FUNCTION double operator()(const int a[3], const int b[3], double da, double db) const {
        const int before[3] = {2 * a[0] - b[0], 2 * a[1] - b[1], 2 * a[2] - b[2]};
        const int after[3] = {2 * b[0] - a[0], 2 * b[1] - a[1], 2 * b[2] - a[2]};
        if (!in_window(before) || !in_window(after)) return 0;
        const bool as_stored = da == solid(nodes.index(a[0], a[1], a[2])) && db == solid(nodes.index(b[0], b[1], b[2]));
        if (!as_stored) return 0;
        const double at_a = solid(nodes.index(before[0], before[1], before[2])) - 2 * da + db;
        const double at_b = da - 2 * db + solid(nodes.index(after[0], after[1], after[2]));
        const int axes = (a[0] != b[0]) + (a[1] != b[1]) + (a[2] != b[2]);
        const double most = 0.5 * axes * most_bend();
        if (!(at_a * at_b > 0) || math::fabs(at_a) > most || math::fabs(at_b) > most) return 0;
        return 2 * at_a * at_b / (at_a + at_b);
    }
};

// Area and first moments about corner 0 of a part of a unit square.
struct SquarePart {
    double area = 0, x = 0, y = 0;

    KOKKOS_INLINE_FUNCTION void add(double sign, const double a[2], const double b[2], const double c[2]) {
        const double middle[2] = {(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3};
        add(sign * triangle(a, b, c), middle);
    }
    KOKKOS_INLINE_FUNCTION void add(double size, const double middle[2]) {
        area += size;
        x += size * middle[0];
        y += size * middle[1];
    }
    KOKKOS_INLINE_FUNCTION static double triangle(const double a[2], const double b[2], const double c[2]) {
        return 0.5 * math::fabs((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
    }
};

// A triangle with the distances at its corners, and how they bend along its edges: second differences, of edge (i, j) at i + j - 1.
struct BentTriangle {
    double corner[3][2], distance[3], bend[3];

    // True where the surface may pass through it.
    KOKKOS_INLINE_FUNCTION bool may_be_cut() const {
        double most = 0, least = math::fabs(distance[0]);
        for (int k = 0; k < 3; ++k) {
            most = math::max(most, math::fabs(bend[k]));
            least = math::min(least, math::fabs(distance[k]));
        }
        const bool inside = distance[0] < 0;
        return least <= most || inside != (distance[1] < 0) || inside != (distance[2] < 0);
    }
    // Between the corners i and j, at the end k of a triangle.
    KOKKOS_INLINE_FUNCTION void set_to_middle(int i, int j, BentTriangle& out, int k) const {
        for (int d = 0; d < 2; ++d) out.corner[k][d] = 0.5 * (corner[i][d] + corner[j][d]);
        out.distance[k] = 0.5 * (distance[i] + distance[j]) - 0.125 * bend[i + j - 1];
    }
    // One of four: those at the corners, and the one between these.
    KOKKOS_INLINE_FUNCTION BentTriangle quarter(int part) const {
        BentTriangle out;
        const int i = part % 3, j = (i + 1) % 3, l = (i + 2) % 3;
        if (part < 3) {
            for (int d = 0; d < 2; ++d) out.corner[0][d] = corner[i][d];
            out.distance[0] = distance[i];
        } else {
            set_to_middle(j, l, out, 0);
        }
        set_to_middle(i, j, out, 1);
        set_to_middle(i, l, out, 2);
        const double beside[2] = {bend[i + j - 1], bend[i + l - 1]};
        out.bend[0] = 0.25 * beside[part < 3 ? 0 : 1];
        out.bend[1] = 0.25 * beside[part < 3 ? 1 : 0];
        out.bend[2] = 0.25 * bend[j + l - 1];
        return out;
    }
    // The part where the distance is negative, by a line that crosses two edges where the distance is zero, and a parabola over that line: bent
    // surfaces differ from the line by h^2 / 8 R, which for what turns along them is a flow across.
    KOKKOS_INLINE_FUNCTION void add_negative(SquarePart& sum) const {
        int o[3];
        const int negative = order_by_sign<3>(distance, o);
        if (negative == 0) return;
        if (negative > 1) sum.add(1, corner[0], corner[1], corner[2]);
        if (negative == 3) return;
        const int alone = o[negative == 1 ? 0 : 2], first = o[negative == 1 ? 1 : 0], second = o[negative == 1 ? 2 : 1];
        const double to_first = crossing(alone, first), to_second = crossing(alone, second);
        double a[2], b[2], middle[2];
        for (int d = 0; d < 2; ++d) {
            a[d] = corner[alone][d] + to_first * (corner[first][d] - corner[alone][d]);
            b[d] = corner[alone][d] + to_second * (corner[second][d] - corner[alone][d]);
            middle[d] = 0.5 * (a[d] + b[d]);
        }
        const double sign = negative == 1 ? 1 : -1;
        sum.add(sign, corner[alone], a, b);
        sum.add(
            sign * SquarePart::triangle(corner[alone], a, b) * lune(alone, first, second, to_first, to_second), middle);
    }

private:
    // Bend of an edge that crosses the surface once.
    KOKKOS_INLINE_FUNCTION double limited_bend(int from, int to) const {
        const double most = math::fabs(distance[to] - distance[from]);
        return math::max(-most, math::min(most, bend[from + to - 1]));
    }
    // Fraction of the edge between two corners, whose distances differ in sign, that lies on the first one's side: the zero of
    // d + rise t - bend t (1 - t) / 2.
    KOKKOS_INLINE_FUNCTION double crossing(int from, int to) const {
        const double here = distance[from], bent = limited_bend(from, to), slope = distance[to] - here - 0.5 * bent;
        const double root = math::sqrt(math::max(0.0, slope * slope - 2 * bent * here));
        return math::max(0.0, math::min(1.0, -2 * here / (slope + (slope < 0 ? -root : root))));
    }
    // Area between the line and the surface over that of the corner that the line cuts off: by the distance at the line's middle.
    KOKKOS_INLINE_FUNCTION double lune(int alone, int first, int second, double to_first, double to_second) const {
        const double at_first = 0.5 * to_first, at_second = 0.5 * to_second, at_alone = 1 - at_first - at_second;
        const double straight = at_alone * distance[alone] + at_first * distance[first] + at_second * distance[second];
        const double bent = limited_bend(alone, first) * at_alone * at_first +
                            limited_bend(alone, second) * at_alone * at_second +
                            bend[first + second - 1] * at_first * at_second;
        constexpr double most = 0.5;
        if (distance[alone] == 0) return 0;
        return math::max(-most, math::min(most, 4.0 / 3.0 * (straight - 0.5 * bent) / distance[alone]));
    }
};

// A square between four fine nodes with their distances, numbered x + 2 y along the face's axes.
struct FaceSquare {
    int node[4][3];
    double distance[4];

    // Part (i, j) of the lower face of cell c across an axis, 0 or 1 along the two after it.
    KOKKOS_INLINE_FUNCTION void set_nodes(int dimensions, int axis, const int c[3], int i, int j) {
        for (int k = 0; k < 4; ++k) {
            for (int d = 0; d < 3; ++d) node[k][d] = 2 * c[d];
            node[k][(axis + 1) % 3] += i + (k & 1);
            node[k][(axis + 2) % 3] += j + (k >> 1);
            if (dimensions == 2) node[k][2] = 0;
        }
    }
    // The part where the distance is negative; two triangles on either side of the diagonal from corner `start`, each of four.
    KOKKOS_INLINE_FUNCTION SquarePart closed(const SolidBends& bends, int start) const {
        SquarePart sum;
        if (is_far(bends.most_bend())) {
            constexpr double middle[2] = {0.5, 0.5};
            if (distance[0] < 0) sum.add(1, middle);
            return sum;
        }
        for (int t = 1; t <= 2; ++t) {
            const int at[3] = {start, t ^ start, 3 ^ start};
            const BentTriangle whole = triangle(bends, at);
            if (!whole.may_be_cut()) {
                whole.add_negative(sum);
                continue;
            }
            for (int part = 0; part < 4; ++part) whole.quarter(part).add_negative(sum);
        }
        return sum;
    }

private:
    // True where the surface is farther than `bend` from all nodes, on one side of them.
    KOKKOS_INLINE_FUNCTION bool is_far(double bend) const {
        bool outside = true, inside = true;
        for (const double d : distance) {
            outside = outside && d > bend;
            inside = inside && d < -bend;
        }
        return outside || inside;
    }
    KOKKOS_INLINE_FUNCTION BentTriangle triangle(const SolidBends& bends, const int at[3]) const {
        BentTriangle out;
        for (int i = 0; i < 3; ++i) {
            out.corner[i][0] = at[i] & 1;
            out.corner[i][1] = at[i] >> 1;
            out.distance[i] = distance[at[i]];
            for (int j = i + 1; j < 3; ++j) {
                const double here = distance[at[i]], there = distance[at[j]],
                             bend = bends(node[at[i]], node[at[j]], here, there);
                const double most =
                    3.9 * math::fabs(there - here); // by more than 4 the middle would be on the other side
                const bool differ = (here < 0) != (there < 0);
                out.bend[i + j - 1] = differ ? math::max(-most, math::min(most, bend)) : bend;
            }
        }
        return out;
    }
};

} // namespace treacle::grid
