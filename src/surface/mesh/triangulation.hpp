#pragma once
#include "surface/field/implicit_function.hpp"

namespace treacle::surface {

// The surface as triangles (2D: segments) in this rank's cells and in some layers around them; the latter are those of
// the neighbours, bit for bit.
struct Patch {
    int vertices = 0, triangles = 0;
    Array<double> position;  // [vertices * 3] [m]
    Array<std::int64_t> key; // [vertices] LatticeKey of doubled global node numbers: an edge's middle, a cell's, a node
    Array<int> fixed;        // [vertices] bits of axes along which smoothing leaves it; bit 3: whole
    Array<int> corner;       // [triangles * 3] rows of vertices; 2D: [triangles * 2]
    Array<int> own;          // [triangles] 1: of a cell of this rank
    int corners_per_triangle = 3;
};

// Triangles of a function's surface in this rank's cells and in layers around them, made anew for each frame.
class Triangulation {
public:
    // `layers` around the rank's box, in lattice cells: up to 7.
    const Patch& build(const Lattice& lattice, const CellBox& box, const ImplicitFunction& function, int layers);
    Patch& patch() { return patch_; }

    // Data for kernels.
    struct View {
        Lattice lattice;
        NodeField field;
        Array<int> mask, first; // [slots * nodes] vertices of a node: bits, and the first of them
        Array<double> position; // [vertices * 3] [m]
        CellBox box;            // tiles of this rank
        CellBox cells;          // lattice cells in question

        // The vertex on the edge along `axis` from a node.
        KOKKOS_INLINE_FUNCTION int edge_vertex(const int node[3], int axis) const;
        KOKKOS_INLINE_FUNCTION int centre_vertex(const int node[3]) const;
        KOKKOS_INLINE_FUNCTION bool own_cell(const int cell[3]) const;
        // Cell number `item` of a slot's; false where there is none to mesh.
        KOKKOS_INLINE_FUNCTION bool cell(const int tile[3], int item, int out[3]) const;
        KOKKOS_INLINE_FUNCTION double value(const int node[3]) const {
            return lattice.outside(node) ? -far : field.at(node);
        }
    };

    // Kernels (public for nvcc).
    void mark_vertices(const View& view, const Array<int>& tiles, int slots);
    void mark_centres(const View& view, const Array<int>& tiles, int slots);
    void compute_vertices(const View& view, const ImplicitFunction& function);
    void compute_centres(const View& view, const Array<int>& tiles, int slots);
    void count_triangles(const View& view, const Array<int>& tiles, int slots);
    void fill_triangles(const View& view, const Array<int>& tiles, int slots);

private:
    Patch patch_;
    Array<int> mask_{"treacle::vertex_mask", 0}, first_{"treacle::vertex_first", 0},
        counts_{"treacle::triangle_counts", 0};
};

} // namespace treacle::surface
