#pragma once
#include "base/text/vec3.hpp"

#include <array>

namespace treacle::surface {

// End of the surface at a side of the domain.
enum class Side {
    open, // the surface goes on
    wall, // the surface is cut; the liquid is mirrored behind it
    periodic,
    cut, // the surface is cut; the liquid goes on
};

// The block of space that holds the liquid. Where the surface is cut it lies on the side.
struct Domain {
    int dimensions = 3;
    Vec3 min{0, 0, 0}, max{0, 0, 0}; // [m]
    std::array<Side, 6> sides{
        Side::open, Side::open, Side::open, Side::open, Side::open, Side::open}; // x_min, x_max, y_min, ...
};

inline constexpr int most_scalars = 16;

// The part of a domain in a box: the surface is cut at the box's sides that lie in it. InputError for a box without space in
// the domain, and for one that cuts a periodic axis.
Domain cropped(const Domain& domain, const Vec3& min, const Vec3& max);

// Lengths are in spacings, but that of the spacing [m]. Mesher refuses values out of their ranges (InputError).
struct Options {
    double spacing = 0;           // of the particles; each stands for spacing^dimensions [m]
    double lattice_step = 0.5;    // edge of the lattice's cells, in spacings
    double kernel_width = 1.25;   // h of the cubic B-spline, in spacings; its support radius is 2 h
    int deconvolution_passes = 2; // 0 to 20
    double interface_width = 0.5; // of the smoothed indicator in the deconvolution, in spacings
    double iso = 0;               // value of F at the surface, in spacings: above 0 it lies deeper in the liquid
    int smoothing_passes = 3;     // Taubin's, 0 to 3
    int liquid = -1;              // the one whose surface it is; -1: of all together
    int scalars = 0;              // further numbers of the particles that vertices take, up to most_scalars
    double min_volume = 0;        // closed surfaces that enclose less are dropped, in volumes of a particle
};

} // namespace treacle::surface
