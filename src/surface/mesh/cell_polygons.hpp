#pragma once
#include "kokkos/types.hpp"

// (SM1) The surface in one cell of the lattice: closed polygons over the cell's edges that change sign (Lorensen and
// Cline 1987). Faces with two corners in the liquid across from each other follow the asymptotic decider (Nielson and
// Hamann 1991), which uses the four values of the face only: both cells of a face draw the same segments, in opposite
// directions, so that polygons of neighbouring cells close up whatever the signs are.
namespace treacle::surface {

// Corner c of a cell stands at (c & 1, c >> 1 & 1, c >> 2). Edge e runs along axis e / 4; its lower corner is edge_corner.
KOKKOS_INLINE_FUNCTION constexpr int edge_corner(int edge) {
    const int axis = edge / 4, k = edge % 4;
    const int a = k & 1, b = k >> 1; // along the two other axes, in rising order
    return axis == 0 ? 2 * a + 4 * b : axis == 1 ? a + 4 * b : a + 2 * b;
}
KOKKOS_INLINE_FUNCTION constexpr int edge_of(int axis, int lower) {
    return axis == 0 ? lower >> 1 : axis == 1 ? 4 + ((lower & 1) | (lower >> 1 & 2)) : 8 + (lower & 3);
}
// Bits of the two faces (2 axis + side) that an edge lies on.
KOKKOS_INLINE_FUNCTION constexpr int edge_faces(int edge) {
    const int axis = edge / 4, corner = edge_corner(edge);
    int bits = 0;
    for (int k = 0; k < 3; ++k) {
        if (k != axis) bits |= 1 << (2 * k + (corner >> k & 1));
    }
    return bits;
}
// Corner number `turn` of a face, counter-clockwise from outside of the cell.
KOKKOS_INLINE_FUNCTION constexpr int face_corner(int face, int turn) {
    const int axis = face / 2, side = face % 2;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const int step = side == 1 ? turn : (4 - turn) % 4;
    const int a = step == 1 || step == 2 ? 1 : 0, b = step >= 2 ? 1 : 0;
    return (side << axis) | (a << u) | (b << v);
}

// True when the corners in the liquid of a face with two of them across are joined, from its values in turn.
KOKKOS_INLINE_FUNCTION bool joined(const double value[4]) {
    const double a = value[0] * value[2], b = value[1] * value[3];
    return value[0] > 0 ? a > b : b > a;
}

// Follows edges: next[e] is the edge after e on its polygon, -1 off the surface. The liquid is where values are > 0;
// polygons are counter-clockwise from outside of the liquid.
KOKKOS_INLINE_FUNCTION void link_edges(const double value[8], int next[12]) {
    for (int e = 0; e < 12; ++e) next[e] = -1;
    for (int face = 0; face < 6; ++face) {
        double v[4];
        int corner[4], edges[4], count = 0;
        bool enters[4];
        for (int t = 0; t < 4; ++t) {
            corner[t] = face_corner(face, t);
            v[t] = value[corner[t]];
        }
        for (int t = 0; t < 4; ++t) {
            const int n = (t + 1) & 3;
            if ((v[t] > 0) == (v[n] > 0)) continue;
            const int differs = corner[t] ^ corner[n];
            const int lower = math::min(corner[t], corner[n]);
            edges[count] = edge_of(differs >> 1, lower);
            enters[count] = v[n] > 0;
            ++count;
        }
        const bool over_liquid = count == 4 && joined(v);
        for (int k = 0; k < count; ++k) {
            if (enters[k]) continue;
            // From where the face's rim leaves the liquid to where it enters: around a dry corner, or back.
            const int other = over_liquid || count == 2 ? (k + 1) % count : (k + count - 1) % count;
            next[edges[other]] = edges[k];
        }
    }
}

// Takes the polygons out of next[12]: calls add(edge) for each edge of one in turn, then end().
template <class Add, class End>
KOKKOS_INLINE_FUNCTION void follow_polygons(int next[12], const Add& add, const End& end) {
    for (int e = 0; e < 12; ++e) {
        if (next[e] < 0) continue;
        int at = e;
        do {
            add(at);
            const int to = next[at];
            next[at] = -1;
            at = to;
        } while (at != e);
        end();
    }
}

// A polygon's vertices, without those that coincide.
struct Polygon {
    int n = 0;
    int vertex[12], faces[12]; // faces: bits, see edge_faces()

    // The next vertex, on these faces.
    KOKKOS_INLINE_FUNCTION void add(int v, int on) {
        if (n > 0 && vertex[n - 1] == v) {
            faces[n - 1] |= on;
            return;
        }
        vertex[n] = v;
        faces[n] = on;
        ++n;
    }
    // End of the polygon: its last vertex may be the first one again.
    KOKKOS_INLINE_FUNCTION void close() {
        if (n > 1 && vertex[n - 1] == vertex[0]) {
            faces[0] |= faces[n - 1];
            --n;
        }
    }
};

// Triangles of one polygon, shortest in the sum of their diagonals, none of which lies in a face of the cell: a diagonal
// there could be the other cell's as well, and an edge of four triangles. Returns their number; -1 when there is no such
// triangulation. `length(i, j)`: of the diagonal between two vertices of the polygon.
template <class Length>
KOKKOS_INLINE_FUNCTION int triangulate_polygon(int n, const int faces[12], const Length& length, int triangles[10][3]) {
    if (n < 3) return 0;
    constexpr double never = 1e300;
    double best[12][12];
    int apex[12][12];
    const auto diagonal = [&](int i, int j) {
        if (j == i + 1 || (i == 0 && j == n - 1)) return 0.0;
        return (faces[i] & faces[j]) != 0 ? never : length(i, j);
    };
    for (int span = 1; span < n; ++span) {
        for (int i = 0; i + span < n; ++i) {
            const int j = i + span;
            best[i][j] = span == 1 ? 0 : never;
            apex[i][j] = -1;
            const double own = diagonal(i, j);
            if (span == 1 || own >= never) continue;
            for (int k = i + 1; k < j; ++k) {
                if (best[i][k] >= never || best[k][j] >= never) continue;
                const double sum = own + best[i][k] + best[k][j];
                if (sum < best[i][j]) {
                    best[i][j] = sum;
                    apex[i][j] = k;
                }
            }
        }
    }
    if (best[0][n - 1] >= never) return -1;
    int stack[24], top = 0, count = 0;
    stack[top++] = 0;
    stack[top++] = n - 1;
    while (top > 0) {
        const int j = stack[--top], i = stack[--top];
        if (j - i < 2) continue;
        const int k = apex[i][j];
        triangles[count][0] = i;
        triangles[count][1] = k;
        triangles[count][2] = j;
        ++count;
        stack[top++] = i;
        stack[top++] = k;
        stack[top++] = k;
        stack[top++] = j;
    }
    return count;
}

} // namespace treacle::surface
