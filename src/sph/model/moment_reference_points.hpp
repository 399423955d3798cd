#pragma once
#include "kokkos/types.hpp"

#include <vector>

namespace treacle::sph {

// Point about which the torque on each body is taken: its centre for bodies that move, otherwise the origin.
struct MomentReferencePoints {
    int count = 0;
    bool moving = false;          // any of them is not the origin
    Array<double> centre;         // [count][4]: the point [m] and 1, or 0 for the origin; when moving
    double period[3] = {0, 0, 0}; // of periodic axes, 0 of others [m]
    Array<double> scale;          // [count] factor on the volumes of the solid's particles, when moving

    MomentReferencePoints(int bodies = 0) : count(bodies) {} // all of them the origin

    // True for a body whose point is its centre.
    KOKKOS_INLINE_FUNCTION bool moves(int body) const { return moving && centre(4 * body + 3) != 0; }

    // The lever arm of a point that belongs to a body.
    KOKKOS_INLINE_FUNCTION void arm(int body, const double x[3], double out[3]) const {
        for (int k = 0; k < 3; ++k) {
            out[k] = x[k];
            if (!moves(body)) continue;
            out[k] -= centre(4 * body + k);
            if (period[k] > 0) out[k] -= period[k] * math::floor(out[k] / period[k] + 0.5);
        }
    }

    // Velocity [m/s] of a point that moves with a body, `motion` being six numbers a body: velocity and spin.
    KOKKOS_INLINE_FUNCTION void velocity(
        const Array<double>& motion, int body, const double x[3], double out[3]) const {
        double lever[3];
        arm(body, x, lever);
        const double* m = &motion(6 * body);
        out[0] = m[0] + m[4] * lever[2] - m[5] * lever[1];
        out[1] = m[1] + m[5] * lever[0] - m[3] * lever[2];
        out[2] = m[2] + m[3] * lever[1] - m[4] * lever[0];
    }

    // Adds a force [N] at a point of a body to its load, 6 numbers.
    KOKKOS_INLINE_FUNCTION void add(double load[], int body, const double x[3], const double force[3]) const {
        double lever[3];
        arm(body, x, lever);
        for (int k = 0; k < 3; ++k) load[k] += force[k];
        load[3] += lever[1] * force[2] - lever[2] * force[1];
        load[4] += lever[2] * force[0] - lever[0] * force[2];
        load[5] += lever[0] * force[1] - lever[1] * force[0];
    }

    // Adds c J^T J to the 6 x 6 numbers of a body, J being how its motion moves the point.
    KOKKOS_INLINE_FUNCTION void add_stiffness(double stiffness[], int body, const double x[3], double c) const {
        double a[3];
        arm(body, x, a);
        const double move[6][3] = {
            {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -a[2], a[1]}, {a[2], 0, -a[0]}, {-a[1], a[0], 0}};
        double* of = stiffness + 36 * body;
        for (int k = 0; k < 6; ++k) {
            for (int l = 0; l < 6; ++l) {
                of[6 * k + l] += c * (move[k][0] * move[l][0] + move[k][1] * move[l][1] + move[k][2] * move[l][2]);
            }
        }
    }
};

// Common part of reductions to 6 numbers per body. The order of the sums is fixed.
struct LoadReduction {
    using value_type = double[];
    using size_type = std::size_t;
    size_type value_count; // 6 per body

    // Interface that Kokkos has for reductions to an array.
    KOKKOS_INLINE_FUNCTION void init(value_type sum) const {
        for (size_type k = 0; k < value_count; ++k) sum[k] = 0;
    }
    KOKKOS_INLINE_FUNCTION void join(value_type sum, const value_type other) const {
        for (size_type k = 0; k < value_count; ++k) sum[k] += other[k];
    }
};

// View in which such a reduction leaves its sums; the vector owns their memory.
inline auto host_sums(std::vector<double>& sums) {
    using View = Kokkos::View<double*, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>; // not counted
    return View(sums.data(), sums.size());
}

// Numbers per body, for kernels.
inline Array<double> upload(const std::vector<double>& values) {
    Array<double> out("treacle::upload", values.size());
    auto host = Kokkos::create_mirror_view(out);
    for (std::size_t k = 0; k < values.size(); ++k) host(k) = values[k];
    Kokkos::deep_copy(out, host);
    return out;
}

} // namespace treacle::sph
