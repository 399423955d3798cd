#pragma once
#include "sph/model/lattice.hpp"
#include "sph/model/neighbourhood.hpp"

namespace treacle::sph {

// The constants of walls with a slip length (wall_slip.hpp), of a lattice at rest beside a plane wall:
// wall_volume, and wall_kernel_sum with the support of the viscous sums [m].
void measure_slip(const WallSetup& wall, const DensityOptions& density, double viscous_support, Constants& constants);

} // namespace treacle::sph
