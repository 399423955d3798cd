#pragma once
#include "grid/geometry/fractions.hpp"
#include "grid/mac/polyhedron.hpp"

namespace treacle::grid {

// Kinds of cells that are of one sort all through, as numbers below 0: bit 0 of -1 - kind: liquid, bit 1: solid.
constexpr int kinds = 4;
constexpr int kind_of(bool liquid, bool solid) { return -1 - (liquid ? 1 : 0) - (solid ? 2 : 0); }
constexpr int empty_kind = kind_of(false, false);
constexpr int cut_kind = 0;              // in written_: cut by a surface
constexpr int dry_kind = 1;              // in written_: cut by that of solids, without liquid
constexpr int unknown_kind = -1 - kinds; // in written_: never written

// Fractions of a cell of one sort all through; `kind` is one of kind_of().
KOKKOS_INLINE_FUNCTION CubeFractions fractions_of(int kind) {
    const int bits = -1 - kind;
    const double liquid = bits & 1 ? 1 : 0, fluid = bits & 2 ? 0 : 1;
    return {fluid, liquid, fluid * liquid};
}

// Cubes around the centres, faces and edges of the cells of a window.
struct ControlVolumes {
    FineNodes nodes;
    int up[3]; // 1, and 0 along the flat axis of 2D scenes
    WallPlanes walls;

    // Nodes of a window and the walls among the solids there, if any.
    ControlVolumes(const FineNodes& of, const WallPlanes& sides)
        : nodes(of), up{1, 1, of.dimensions == 2 ? 0 : 1}, walls(sides) {}
    // Cells whose parts have all their corners in the window.
    KOKKOS_INLINE_FUNCTION bool has_parts(const int c[3]) const {
        for (int k = 0; k < nodes.dimensions; ++k) {
            if (c[k] + 1 >= nodes.window.hi[k]) return false;
        }
        return true;
    }
    // Cells whose faces and edges have all their parts in the window.
    KOKKOS_INLINE_FUNCTION bool has_volumes(const int c[3]) const {
        for (int k = 0; k < nodes.dimensions; ++k) {
            if (c[k] <= nodes.window.lo[k]) return false;
        }
        return has_parts(c);
    }
    // 1 or -1 for a node on the plane of a wall whose liquid side the part between fine nodes f and f + 1 is along an axis, 0 for one that
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
    // Distance at a corner of the part with lower fine node f: on the plane of a wall that of bodies, linear along the wall's normal from the two
    // nodes before. `flat`: the axis that the part is flat along, whose walls close it; -1: none.
    KOKKOS_INLINE_FUNCTION double solid_beside(
        const Array<double>& solid, const int corner[3], const int f[3], int flat) const {
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
        return math::max(here,
            2 * solid(nodes.index(first[0], first[1], first[2])) - solid(nodes.index(second[0], second[1], second[2])));
    }
    // The corners, x + 2 y + 4 z, of the cube with lower fine node f and edges of `step` fine nodes: use(number, fine node).
    template <class Use>
    KOKKOS_INLINE_FUNCTION void each_corner(const int f[3], int step, const Use& use) const {
        for (int k = 0; k < 8; ++k) {
            const int corner[3] = {
                f[0] + step * (k & 1), f[1] + step * (k >> 1 & 1), up[2] ? f[2] + step * (k >> 2) : 0};
            use(k, corner);
        }
    }
    KOKKOS_INLINE_FUNCTION void solid_corners(const Array<double>& solid, const int f[3], double out[8]) const {
        each_corner(f, 1, [&](int k, const int corner[3]) { out[k] = solid_beside(solid, corner, f, -1); });
    }
    KOKKOS_INLINE_FUNCTION void corners(const Array<double>& values, const int f[3], int step, double out[8]) const {
        each_corner(f, step,
            [&](int k, const int corner[3]) { out[k] = values(nodes.index(corner[0], corner[1], corner[2])); });
    }
};

// Cell around a cube that the part belongs to, and the part's number: cubes in the middle of a cell along an axis
// have both halves of it, others the upper half of the cell below and the lower half of their own.
struct PartSum {
    ControlVolumes volumes;
    Array<int> slot;     // [window] >= 0: row of parts; below: kind of the whole cell
    Array<int> dry;      // [window] 1: no node of the cell is in the liquid
    Array<double> parts; // [rows][8][3] fluid, liquid, wet of each part of a cut cell [1]

    // `node`: bit k: the cube is at the lower end of its cell along axis k.
    KOKKOS_INLINE_FUNCTION CubeFractions at(const int c[3], int node) const {
        CubeFractions sum;
        const int used = volumes.nodes.used();
        for (int p = 0; p < used; ++p) {
            // Part p counted from the lower end of the cube.
            int q[3], own = 0;
            for (int k = 0; k < 3; ++k) {
                const int below = (node >> k & 1) & ~(p >> k) & 1;
                q[k] = c[k] - below;
                own |= ((p >> k ^ node >> k) & 1) << k;
            }
            const int row = slot(volumes.nodes.window.index(q[0], q[1], q[2]));
            if (row < 0) {
                const CubeFractions whole = fractions_of(row);
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
    // The kind of all cells that the cubes of cell c are part of, or cut_kind, or dry_kind.
    KOKKOS_INLINE_FUNCTION int kind(const int c[3]) const {
        const CellBox& window = volumes.nodes.window;
        const int first = slot(window.index(c[0], c[1], c[2]));
        bool same = first < 0, is_dry = true;
        for (int z = -volumes.up[2]; z <= 0; ++z) {
            for (int y = -1; y <= 0; ++y) {
                for (int x = -1; x <= 0; ++x) {
                    const auto at = window.index(c[0] + x, c[1] + y, c[2] + z);
                    same = same && slot(at) == first;
                    is_dry = is_dry && dry(at) != 0;
                }
            }
        }
        return same ? first : is_dry ? dry_kind : cut_kind;
    }
};

// Bit k of a node: its cube is at the lower end of its cell along axis k.
KOKKOS_INLINE_FUNCTION int face_node(int axis) { return 1 << axis; }

} // namespace treacle::grid
