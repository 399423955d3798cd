#pragma once
#include "kokkos/particle_store.hpp"
#include "surface/field/lattice.hpp"

namespace treacle::surface {

// Points that the implicit function is summed over: the particles of this rank and its neighbours, and their mirror
// images behind walls and in solids. Sorted into bins of two lattice cells, bin by bin of each tile; within a bin by id
// and image, so that sums have the same order on any number of ranks.
struct Points {
    CellBox window;            // tiles
    Array<int> tile;           // [tiles of window] number among the tiles that hold points, -1: none
    Array<int> begin;          // [tiles with points * bins + 1] first point of each bin
    Array<double> position[3]; // [points] position in lattice steps from the grid's first node
    Array<int> row;            // [points] row of the particle in its store
    Array<int> original;       // [points] 0: an image
    Array<int> liquid;         // [points]
    int count = 0;
    int tiles = 0; // that hold points
};

// The points of a bin, numbered over all tiles; none outside of the window.
KOKKOS_INLINE_FUNCTION void points_of_bin(
    const Points& points, const int bin[3], int dimensions, int& begin, int& end) {
    begin = end = 0;
    const int c[3] = {bin[0] >> 2, bin[1] >> 2, dimensions == 3 ? bin[2] >> 2 : 0};
    if (!points.window.contains(c)) return;
    const int tile = points.tile(points.window.index(c[0], c[1], c[2]));
    if (tile < 0) return;
    const int z = dimensions == 3 ? bin[2] & 3 : 0;
    const int per_tile = dimensions == 3 ? 64 : 16;
    const int b = tile * per_tile + (bin[0] & 3) + bins_edge * ((bin[1] & 3) + bins_edge * z);
    begin = points.begin(b);
    end = points.begin(b + 1);
}

// Fields of the store.
struct PointFields {
    int image; // not 0 for images in solids (solid_images.hpp)
    int liquid;
};

// Builds the points. Kept between frames for its arrays.
class PointBuilder {
public:
    // `window`: this rank's tiles and a layer around them. `support`: of the kernel [m].
    const Points& build(const ParticleStore& store, const PointFields& fields, const Lattice& lattice,
        const CellBox& window, double support);

    // Kernels (public for nvcc).
    void take_particles(const ParticleStore& store, const PointFields& fields);
    void mirror_at_walls(const Lattice& lattice, double support, int axis);
    void locate_points(const Lattice& lattice, const CellBox& window);
    void sort_into_bins(int per_tile);
    void order_bins();
    void pack_points(const Lattice& lattice);

private:
    void reserve_points(int n);

    Points points_;
    int n_ = 0;
    Array<double> x_[3];
    Array<int> liquid_of_row_;
    Array<int> source_{"treacle::surface_source", 0}, bin_{"treacle::surface_bin", 0},
        slot_{"treacle::surface_slot", 0}, order_{"treacle::surface_order", 0}, counts_{"treacle::surface_images", 0};
    Array<std::int64_t> id_{"treacle::surface_id", 0}, image_{"treacle::surface_image", 0};
    int bins_ = 0;
};

} // namespace treacle::surface
