#pragma once
#include "grid/mac/mac_grid.hpp"
#include "rigid/bodies.hpp"

#include <cstddef>

namespace treacle::grid {

// Motion of the bodies, for kernels.
struct BodyMotion {
    static constexpr int width = 18;
    // [bodies][18] centre [m], velocity [m/s], spin [rad/s]; and B [1/s], 3 x 3: how the chord of a turn in a step differs from
    // the spin, (R - I)/dt - [spin]x, zero outside of a step.
    Array<double> frame{"treacle::body_motion", 0};
    int bodies = 0;
    double period[3]{0, 0, 0}; // [m], 0: not periodic
    double side[6][3]{};       // [m/s] of the domain's sides along themselves

    // Arm from the centre of body to x, by the shortest way across periods [m].
    KOKKOS_INLINE_FUNCTION void arm(int body, const double x[3], double r[3]) const {
        for (int k = 0; k < 3; ++k) {
            r[k] = x[k] - frame(width * body + k);
            if (period[k] > 0) r[k] -= period[k] * math::floor(r[k] / period[k] + 0.5);
        }
    }
    // Velocity of the point at r from the centre in the rigid motion: normal velocity of liquid that slips [m/s].
    KOKKOS_INLINE_FUNCTION double rigid_velocity(int body, int axis, const double r[3]) const {
        const int at = width * body, b = (axis + 1) % 3, c = (axis + 2) % 3;
        return frame(at + 3 + axis) + frame(at + 6 + b) * r[c] - frame(at + 6 + c) * r[b];
    }
    // Velocity of the same point along its chord in the step: velocity of liquid that does not slip [m/s].
    KOKKOS_INLINE_FUNCTION double velocity(int body, int axis, const double r[3]) const {
        return rigid_velocity(body, axis, r) + bend(body, axis, r);
    }
    // Difference of the two, chord less rigid motion [m/s].
    KOKKOS_INLINE_FUNCTION double bend(int body, int axis, const double r[3]) const {
        const int at = width * body + 9 + 3 * axis;
        return frame(at) * r[0] + frame(at + 1) * r[1] + frame(at + 2) * r[2];
    }
    // Strain rates of that difference [1/s]: xx, yy, zz, xy, yz, zx.
    KOKKOS_INLINE_FUNCTION void strains(int body, double out[6]) const {
        const int at = width * body + 9;
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3;
            out[a] = frame(at + 4 * a);
            out[3 + a] = 0.5 * (frame(at + 3 * a + b) + frame(at + 3 * b + a));
        }
    }
    // Velocity of solid `number` (Solids::number) at x [m/s], along its chord or, without `sticks`, of its rigid motion; 0 for none.
    KOKKOS_INLINE_FUNCTION void velocity(int number, const double x[3], double u[3], bool sticks = true) const {
        double r[3] = {0, 0, 0};
        if (number >= 0) arm(number, x, r);
        for (int k = 0; k < 3; ++k) {
            u[k] = number >= 0    ? rigid_velocity(number, k, r) + (sticks ? bend(number, k, r) : 0.0)
                   : number >= -6 ? side[-1 - number][k]
                                  : 0.0;
        }
    }
};

// Adds the load of a unit force along the axis at r from the centre: force, and torque about the centre. The
// transpose of BodyMotion::velocity.
KOKKOS_INLINE_FUNCTION void add_load(int axis, const double r[3], double force, double load[6]) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    load[axis] += force;
    load[3 + b] += r[c] * force;
    load[3 + c] -= r[b] * force;
}

// Motion at the present poses and velocities of the bodies.
void update_motion(const rigid::RigidBodies& bodies, const MacGrid& grid, BodyMotion& motion);

} // namespace treacle::grid
