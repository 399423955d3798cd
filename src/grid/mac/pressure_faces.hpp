#pragma once
#include "grid/mac/mac_grid.hpp"

#include <cstddef>

namespace treacle::grid {

// Faces for the pressure solve: areas cut by solids (Ng et al. 2009), and the distance of the liquid's surface from the
// centre beside it (Gibou et al. 2002). By windows' places: face a of a place lies between it and the place `stride[a]`
// before it.
struct PressureFaces {
    CellBox window;
    std::ptrdiff_t stride[3]{1, 1, 1};
    int dimensions = 3;
    FaceField area;         // A: share of the face that is not solid
    Array<double> distance; // [m] of centres from the liquid's surface, < 0 inside
    Array<double> jump;     // [Pa] sigma kappa at centres; none without surface tension
    bool has_jump = false;
    double min_theta = 0, min_face_area_fraction = 0; // least theta [1], least share of an area [1]: PressureOptions

    // Every opening counts but for round-off: without a small one the areas of its cells would no longer close to the solid's
    // surface, and liquid that slides along it could not do so without a strain.
    KOKKOS_INLINE_FUNCTION double open(int axis, std::size_t face) const {
        constexpr double round_off = 1e-9;
        const double fraction = area.axis[axis](face);
        return fraction < round_off ? 0.0 : fraction;
    }
    // True when the face's velocity is that of the liquid around: what passes a small opening may be any, and is not
    // for particles.
    KOKKOS_INLINE_FUNCTION bool carries(int axis, std::size_t face) const {
        return open(axis, face) > 0 && area.axis[axis](face) >= min_face_area_fraction;
    }
    KOKKOS_INLINE_FUNCTION bool is_liquid(std::size_t cell) const { return distance(cell) < 0; }
    // theta: fraction of the way from a liquid cell's centre to that of one outside that is liquid.
    KOKKOS_INLINE_FUNCTION double theta(std::size_t liquid, std::size_t outside) const {
        return math::max(distance(liquid) / (distance(liquid) - distance(outside)), min_theta);
    }
    // A theta of a face beside cells with a pressure, 0 where it is closed; -1 of others.
    KOKKOS_INLINE_FUNCTION double effective_area_fraction(int axis, std::size_t above) const {
        const std::size_t below = above - static_cast<std::size_t>(stride[axis]);
        const bool wet = is_liquid(above), wet_below = is_liquid(below);
        if (!wet && !wet_below) return -1;
        const double fraction = open(axis, above);
        if (wet && wet_below) return fraction;
        return fraction * (wet ? theta(above, below) : theta(below, above));
    }
    // The pressure at the surface between the two [Pa].
    KOKKOS_INLINE_FUNCTION double surface_pressure(std::size_t liquid, std::size_t outside) const {
        if (!has_jump) return 0;
        const double fraction = theta(liquid, outside);
        return (1 - fraction) * jump(liquid) + fraction * jump(outside);
    }
};

// Window and strides of the faces; arrays and limits are left to the caller.
inline PressureFaces pressure_faces(const CellBox& window, int dimensions) {
    PressureFaces faces;
    faces.window = window;
    faces.dimensions = dimensions;
    for (int k = 1; k < 3; ++k) faces.stride[k] = faces.stride[k - 1] * (window.hi[k - 1] - window.lo[k - 1]);
    return faces;
}

} // namespace treacle::grid
