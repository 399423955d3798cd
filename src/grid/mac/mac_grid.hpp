#pragma once
#include "kokkos/cells.hpp"
#include "kokkos/periodic_box.hpp"
#include "kokkos/types.hpp"
#include "scene/scene.hpp"

namespace treacle::grid {

// Cubes of width dx with velocities on their faces (MAC). Ownership, halos and particle cells are those of `cells`,
// whose cells are these cubes, `padding` of them outside of each side of the domain that is not periodic: walls are
// solids like others, and every face, edge and corner that liquid may touch has a cell of its own above it.
//
// One numbering for all places. With the lower corner of cell c at x_c = lower + dx c:
//   cell c    centre         x_c + dx (1/2, 1/2, 1/2)
//   face a, c lower face     as the centre, but x_c[a] along a; holds u_a
//   edge a, c lower edge     x_c but at the middle along a; holds the shear stress of the other two axes
//   node c    lower corner   x_c
// 2D scenes (dimensions 2) have one layer of cells in z, its middle at z = 0, no halo there, no w, and no edge but
// those along z; their volumes are per metre of depth times dx, and sums are divided by dx where they are reported.
struct MacGrid {
    CellGrid cells;
    double dx = 0;     // [m]
    double lower[3]{}; // [m] lower corner of cell 0
    int dimensions = 3;
    static constexpr int padding = 2;

    // Positions x [m] of the places of cell c; z is 0 in 2D.
    KOKKOS_INLINE_FUNCTION void node(const int c[3], double x[3]) const {
        for (int k = 0; k < 3; ++k) x[k] = lower[k] + dx * c[k];
        if (dimensions == 2) x[2] = 0;
    }
    KOKKOS_INLINE_FUNCTION void centre(const int c[3], double x[3]) const {
        for (int k = 0; k < 3; ++k) x[k] = lower[k] + dx * (c[k] + 0.5);
    }
    KOKKOS_INLINE_FUNCTION void face(int axis, const int c[3], double x[3]) const {
        centre(c, x);
        x[axis] -= 0.5 * dx;
    }
    KOKKOS_INLINE_FUNCTION void edge(int axis, const int c[3], double x[3]) const {
        node(c, x);
        if (axis < dimensions || dimensions == 3) x[axis] += 0.5 * dx;
    }
};

// Grid of the domain's spacing. Throws InputError where the length of a periodic axis is no multiple of it.
MacGrid make_mac_grid(const scene::Domain& domain);
// To wrap places by; sides of other axes are the grid's lower one.
PeriodicBox periodic_box(const MacGrid& grid);

// One number per face of a window: u_a on the lower face of each cell across axis a. 2D scenes leave axis 2 empty.
struct FaceField {
    Array<double> axis[3]; // [window], by the axis that the faces are across
};
// One per edge of a window, by the direction of the edge. 2D scenes use axis 2 alone.
struct EdgeField {
    Array<double> axis[3]; // [window], by the axis that the edges are along
};

// Shares, of the cubes of volume dx^3 around the places of a window, that are filled (dissertation 5.3.3). All come from
// the same parts of the double-resolution grid: over any block of whole cubes faces, edges and centres sum to one volume.
//   fluid   not solid                                     W_F
//   liquid  inside the liquid's surface, which is continued into solids   W_L
//   wet     both at once: the clipped liquid, in the place of the product W_F W_L
struct Fractions {
    Array<double> cell_fluid, cell_liquid, cell_liquid_clipped; // [window] [1]
    FaceField face_fluid, face_liquid, face_liquid_clipped;
    EdgeField edge_fluid, edge_liquid, edge_liquid_clipped;
    FaceField open; // share of the area of each face that is not solid: cut cells of the pressure
};

// Fractions of moving bodies in the cube around a face (W_S of each): compressed by face of the window. Those of a
// face and its fluid fraction sum to at most 1; what is missing belongs to solids that rest.
struct BodyFractions {
    Array<int> first;       // [window + 1]
    Array<int> body;        // [first(window)] number of the body in rigid::RigidBodies
    Array<double> fraction; // [first(window)] W_S [1]
};

} // namespace treacle::grid
