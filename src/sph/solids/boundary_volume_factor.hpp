#pragma once
#include "scene/sampling/sampling.hpp"
#include "sph/model/lattice.hpp"

namespace treacle::sph {

// Factor on the volumes of a body's particles with which liquid stands, on average over the surface, half a spacing off
// it: a single layer counts for less where it is bent, and liquid that has moved stands closer than a lattice. `layer`
// are the body's particles, at the depth equilibrium_wall_distance() - spacing / 2 below its surface. With a factor of 1 a ball of ten
// spacings has the effect of one a few per cent too small, and one of the liquid's density sinks.
struct ScaleSetup {
    WallSetup wall;
    double gap; // equilibrium_wall_distance(wall) [m]
};
double boundary_volume_factor(
    const ScaleSetup& setup, const scene::SolidRegion& region, const std::vector<Vec3>& layer);

} // namespace treacle::sph
