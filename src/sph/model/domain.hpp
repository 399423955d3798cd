#pragma once
#include "kokkos/cells.hpp"
#include "kokkos/periodic_box.hpp"
#include "scene/scene.hpp"

namespace treacle::sph {

// The box that contains the liquid, as kernels need it.
struct DomainBox : PeriodicBox {
    int open[6];       // flow::beyond() of the sides x_min, x_max, y_min, ...
    double leak_depth; // [m] beyond a wall at which a particle has gone through it
    int dimensions;
};
DomainBox make_domain_box(const scene::Domain& domain, double leak_depth);

// Cells of at least the support radius over the domain, with a layer outside of walls and open faces for the
// wall particles. Throws InputError when a periodic axis is shorter than two supports.
CellGrid make_cell_grid(const scene::Domain& domain, double support);

} // namespace treacle::sph
