#pragma once
#include "grid/mac_grid.hpp"
#include "rigid/bodies.hpp"

#include <cstddef>

namespace treacle::grid {

// How the bodies move, as kernels read it.
struct BodyMotion {
    static constexpr int width = 18;
    // [bodies][18] centre [m], velocity [m/s], spin [rad/s]; and B [1/s], 3 x 3: how the chord of a turn in a step differs from
    // the spin, (R - I)/dt - [spin]x, zero outside of a step.
    Array<double> frame{"treacle::body_motion", 0};
    int bodies = 0;
    double period[3]{0, 0, 0}; // [m], 0: not periodic
    double side[6][3]{};       // [m/s] of the domain's sides along themselves

    // From the body's centre to x, by the shortest way.
    KOKKOS_INLINE_FUNCTION void arm(int body, const double x[3], double r[3]) const {
        for (int k = 0; k < 3; ++k) {
            r[k] = x[k] - frame(width * body + k);
            if (period[k] > 0) r[k] -= period[k] * math::floor(r[k] / period[k] + 0.5);
        }
    }
    // Of the point at r from the centre, as a rigid body moves: what liquid that slips has across the surface.
    KOKKOS_INLINE_FUNCTION double rigid_velocity(int body, int axis, const double r[3]) const {
        const int at = width * body, b = (axis + 1) % 3, c = (axis + 2) % 3;
        return frame(at + 3 + axis) + frame(at + 6 + b) * r[c] - frame(at + 6 + c) * r[b];
    }
    // Of the same point along the straight line to where it will be at the end of the step: what liquid that sticks to it has.
    KOKKOS_INLINE_FUNCTION double velocity(int body, int axis, const double r[3]) const {
        return rigid_velocity(body, axis, r) + bend(body, axis, r);
    }
    // What it has of that beside the rigid motion.
    KOKKOS_INLINE_FUNCTION double bend(int body, int axis, const double r[3]) const {
        const int at = width * body + 9 + 3 * axis;
        return frame(at) * r[0] + frame(at + 1) * r[1] + frame(at + 2) * r[2];
    }
    // The strain rates of that: xx, yy, zz, xy, yz, zx.
    KOKKOS_INLINE_FUNCTION void strains(int body, double out[6]) const {
        const int at = width * body + 9;
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3;
            out[a] = frame(at + 4 * a);
            out[3 + a] = 0.5 * (frame(at + 3 * a + b) + frame(at + 3 * b + a));
        }
    }
    // Of solid `number` (Solids::number) at x, as what sticks to it or, without `sticks`, as a rigid body; 0 of none.
    KOKKOS_INLINE_FUNCTION void velocity(int number, const double x[3], double u[3], bool sticks = true) const {
        double r[3] = {0, 0, 0};
        if (number >= 0) arm(number, x, r);
        for (int k = 0; k < 3; ++k) {
            u[k] = number >= 0 ? rigid_velocity(number, k, r) + (sticks ? bend(number, k, r) : 0.0) : number >= -6 ? side[-1 - number][k] : 0.0;
        }
    }
};

// Adds what a unit force along the axis at r from the centre is as a load: force, and torque about the centre. The
// transpose of BodyMotion::velocity.
KOKKOS_INLINE_FUNCTION void add_load(int axis, const double r[3], double force, double load[6]) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    load[axis] += force;
    load[3 + b] += r[c] * force;
    load[3 + c] -= r[b] * force;
}

// Of the bodies' present places and velocities.
void update_motion(const rigid::RigidBodies& bodies, const MacGrid& grid, BodyMotion& motion);

} // namespace treacle::grid
