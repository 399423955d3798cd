#pragma once
#include "kokkos/types.hpp"

// Shares of simplices and cubes on one side of surfaces that are given by their distances at the corners, linear
// between. What has distance 0 counts as outside (sign(0) = +). Exact for planes.
namespace treacle::grid {

// Share of an edge from a point with distance a to the zero between it and one with distance b on the other side.
KOKKOS_INLINE_FUNCTION double cut(double a, double b) { return a / (a - b); }

// The corners of a simplex with negative distance first; returns how many there are.
template <int corners>
KOKKOS_INLINE_FUNCTION int order_by_sign(const double distance[corners], int order[corners]) {
    int negative = 0, other = corners;
    for (int k = 0; k < corners; ++k) {
        if (distance[k] < 0) {
            order[negative++] = k;
        } else {
            order[--other] = k;
        }
    }
    return negative;
}

// Share of a tetrahedron, by volume, where the distance is negative.
KOKKOS_INLINE_FUNCTION double negative_fraction(const double distance[4]) {
    int o[4];
    const int negative = order_by_sign<4>(distance, o);
    if (negative == 0) return 0;
    if (negative == 4) return 1;
    const double a = distance[o[0]], b = distance[o[1]], c = distance[o[2]], d = distance[o[3]];
    if (negative == 1) return cut(a, b) * cut(a, c) * cut(a, d);
    if (negative == 3) return 1 - cut(d, a) * cut(d, b) * cut(d, c);
    // A wedge between the triangles (a, ac, ad) and (b, bc, bd), cut into three tetrahedra.
    const double ac = cut(a, c), ad = cut(a, d), bc = cut(b, c), bd = cut(b, d);
    return bc * bd + ac * ad * (1 - bd) + ac * (1 - bc) * bd;
}

// Share of a tetrahedron that is outside of the solid and inside the liquid: the tetrahedron is clipped by the
// solid's surface into tetrahedra, and those by the liquid's.
KOKKOS_INLINE_FUNCTION double clipped_liquid_fraction(const double solid[4], const double liquid[4]) {
    int o[4];
    const int inside = order_by_sign<4>(solid, o);
    if (inside == 4) return 0;
    if (inside == 0) return negative_fraction(liquid);
    const double a = solid[o[0]], b = solid[o[1]], c = solid[o[2]], d = solid[o[3]];
    const double la = liquid[o[0]], lb = liquid[o[1]], lc = liquid[o[2]], ld = liquid[o[3]];
    if (inside == 1) { // all but the corner at a
        const double ab = cut(a, b), ac = cut(a, c), ad = cut(a, d);
        const double corner[4] = {la, la + ab * (lb - la), la + ac * (lc - la), la + ad * (ld - la)};
        // Never below 0 but by round-off.
        return math::max(0.0, negative_fraction(liquid) - ab * ac * ad * negative_fraction(corner));
    }
    if (inside == 3) { // the corner at d
        const double da = cut(d, a), db = cut(d, b), dc = cut(d, c);
        const double corner[4] = {ld, ld + da * (la - ld), ld + db * (lb - ld), ld + dc * (lc - ld)};
        return da * db * dc * negative_fraction(corner);
    }
    // The wedge between the triangles (c, ca, cb) and (d, da, db).
    const double ca = cut(c, a), cb = cut(c, b), da = cut(d, a), db = cut(d, b);
    const double lca = lc + ca * (la - lc), lcb = lc + cb * (lb - lc), lda = ld + da * (la - ld),
                 ldb = ld + db * (lb - ld);
    const double one[4] = {lc, lca, lcb, ldb}, two[4] = {lc, lca, lda, ldb}, three[4] = {lc, ld, lda, ldb};
    return ca * cb * (1 - db) * negative_fraction(one) + ca * (1 - da) * db * negative_fraction(two) +
           da * db * negative_fraction(three);
}

// Shares of a cube: not solid, inside the liquid's surface, both.
struct CubeFractions {
    double fluid = 0, liquid = 0, wet = 0; // of the cube's volume [1]
};

// Shares of a cube with distances at its corners, numbered x + 2 y + 4 z: six tetrahedra around the diagonal that
// starts at corner `start`. Neighbouring cubes match where their diagonals are mirror images.
KOKKOS_INLINE_FUNCTION CubeFractions cube_fractions(const double solid[8], const double liquid[8], int start) {
    constexpr int path[6][2] = {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}};
    bool any_solid = false, all_solid = true, any_liquid = false, all_liquid = true;
    for (int k = 0; k < 8; ++k) {
        any_solid |= solid[k] < 0;
        all_solid &= solid[k] < 0;
        any_liquid |= liquid[k] < 0;
        all_liquid &= liquid[k] < 0;
    }
    CubeFractions out{any_solid ? 0.0 : 1.0, all_liquid ? 1.0 : 0.0, 0.0};
    const bool cut_solid = any_solid && !all_solid, cut_liquid = any_liquid && !all_liquid;
    if (!cut_solid && !cut_liquid) {
        out.wet = out.fluid * out.liquid;
        return out;
    }
    for (int t = 0; t < 6; ++t) {
        const int v[4] = {start, path[t][0] ^ start, path[t][1] ^ start, 7 ^ start};
        const double s[4] = {solid[v[0]], solid[v[1]], solid[v[2]], solid[v[3]]};
        const double l[4] = {liquid[v[0]], liquid[v[1]], liquid[v[2]], liquid[v[3]]};
        if (cut_solid) out.fluid += (1 - negative_fraction(s)) / 6;
        if (cut_liquid) out.liquid += negative_fraction(l) / 6;
        if (cut_solid && cut_liquid) out.wet += clipped_liquid_fraction(s, l) / 6;
    }
    if (!cut_liquid) out.wet = all_liquid ? out.fluid : 0;
    if (!cut_solid) out.wet = all_solid ? 0 : out.liquid;
    return out;
}

} // namespace treacle::grid
