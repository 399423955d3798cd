#pragma once
#include "sph/model/options.hpp"

namespace treacle::sph {

// A half space of the lattice, its first layer half a spacing below the surface.
struct SurfaceSetup {
    KernelKind kind;
    int dimensions;
    double support; // [m]
    double spacing; // [m]
};

// Mean depth of the layers below the surface, weighted by |N| after `passes` smoothings (surface_curvature.hpp) [m].
double surface_depth(const SurfaceSetup& setup, int passes);

// Surface energy of pairs that attract each other by W(r) r, each of unit strength, for a unit number of particles per
// volume: half the work over the area that takes two half spaces apart [m^2 per unit of strength]; pi/8 of the integral
// of r^5 W in 3D, 1/3 of that of r^4 W in 2D.
double cohesion_energy(const SurfaceSetup& setup);

} // namespace treacle::sph
