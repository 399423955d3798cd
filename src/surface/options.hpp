#pragma once
#include "base/vec3.hpp"

#include <array>

namespace treacle::surface {

enum class Side { open, wall, periodic };

// The block of space that holds the liquid. The surface is cut at walls and periodic sides and lies on them; at open
// sides it goes on.
struct Domain {
    int dimensions = 3;
    Vec3 min{0, 0, 0}, max{0, 0, 0}; // [m]
    std::array<Side, 6> sides{Side::open, Side::open, Side::open, Side::open, Side::open, Side::open}; // x_min, x_max, y_min, ...
};

struct Options {
    double spacing = 0;          // of the particles; each stands for spacing^dimensions [m]
    double lattice_step = 0.5;   // edge of the lattice's cells, in spacings
    double kernel_width = 1.25;  // h of the cubic B-spline, in spacings; its support radius is 2 h
    int deconvolution_passes = 2;
    double interface_width = 0.5; // of the smoothed indicator in the deconvolution, in spacings
    int smoothing_passes = 3;    // Taubin's, 0 to 3
    double min_volume = 0;       // closed surfaces that enclose less are dropped, in volumes of a particle
};

} // namespace treacle::surface
