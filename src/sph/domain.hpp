#pragma once
#include "kokkos/cells.hpp"
#include "scene/scene.hpp"

namespace treacle::sph {

// The box that the liquid lives in, as kernels need it.
struct DomainBox {
    double lo[3], hi[3];  // [m]
    double period[3];     // [m], 0: not periodic
    double quantum = 0;   // positions along periodic axes are multiples of it [m]
    int open[6];          // 1: particles may leave through the face x_min, x_max, y_min, ...
    double leak_depth;    // [m] beyond a wall at which a particle has gone through it
    int dimensions;

    // Moves a point back into the domain along periodic axes. Positions and periods being multiples of one
    // quantum, a particle and its image differ by the period exactly, and pair terms stay symmetric bit for bit.
    KOKKOS_INLINE_FUNCTION double wrap(int axis, double x) const {
        if (period[axis] == 0) return x;
        x = math::floor(x / quantum + 0.5) * quantum;
        if (x < lo[axis]) x += period[axis];
        if (x >= hi[axis]) x -= period[axis];
        return x;
    }
};
DomainBox make_domain_box(const scene::Domain& domain, double leak_depth);

// Cells of at least the support radius over the domain, with a layer outside of walls and open faces for the
// wall particles. Throws InputError when a periodic axis is shorter than two supports.
CellGrid make_cell_grid(const scene::Domain& domain, double support);

} // namespace treacle::sph
