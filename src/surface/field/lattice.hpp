#pragma once
#include "kokkos/cells.hpp"
#include "surface/field/options.hpp"

namespace treacle::surface {

inline constexpr int tile_edge = 8; // lattice cells along the edge of a tile
inline constexpr int bins_edge = 4; // bins along the edge of a tile: two lattice cells each

// The lattice on which the implicit function stands: stationary. Nodes are numbered from `origin`; along axes with a
// wall or a period both faces of the domain are planes of nodes. Tiles of 8 cells an edge are the cells of the
// decomposition. Node numbers below are those from the grid's first tile: global number = number + 8 base.
struct Lattice {
    int dimensions = 3;
    double origin[3] = {0, 0, 0}; // [m] of node 0
    double step[3] = {1, 1, 1};   // [m]
    int base[3] = {0, 0, 0};      // first tile of the grid
    int lo[3], hi[3];             // nodes on the faces at which the surface is cut; beyond any number where it is not
    bool mirror[2][3] = {{false, false, false}, {false, false, false}}; // the liquid goes on mirrored behind the face
    bool periodic[3] = {false, false, false};
    CellGrid grid; // of tiles

    // Coordinate [m] of a node, or of a place between nodes.
    KOKKOS_INLINE_FUNCTION double position(int axis, double node) const {
        return origin[axis] + (node + tile_edge * base[axis]) * step[axis];
    }
    // Outside of the faces at which the surface is cut.
    KOKKOS_INLINE_FUNCTION bool outside(const int node[3]) const {
        for (int k = 0; k < dimensions; ++k) {
            if (node[k] < lo[k] || node[k] > hi[k]) return true;
        }
        return false;
    }
    KOKKOS_INLINE_FUNCTION int depth() const { return dimensions == 3 ? tile_edge : 1; }
    KOKKOS_INLINE_FUNCTION int nodes_per_tile() const { return tile_edge * tile_edge * depth(); }
    KOKKOS_INLINE_FUNCTION int bins_per_tile() const {
        return bins_edge * bins_edge * (dimensions == 3 ? bins_edge : 1);
    }
};

// Lattice of a domain without its block of tiles: steps near `step` [m] that fit between walls and periods.
Lattice make_lattice(const Domain& domain, double step);

// The block of tiles that holds positions from lo to hi [m], with one tile more around it where the domain is open.
void cover(Lattice& lattice, const Domain& domain, const double lo[3], const double hi[3]);

} // namespace treacle::surface
