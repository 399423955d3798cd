#pragma once
#include "grid/mac/mac_grid.hpp"

namespace treacle::grid {

// Position and motion of a particle, for sums over particles.
struct ParticleMotion {
    double x[3];    // [m]
    double u[3];    // [m/s]
    double c[3][3]; // row a: the gradient of u_a [1/s]

    // Particle i of fields [particles][3]; gradient[a] is that of u_a [1/s].
    KOKKOS_INLINE_FUNCTION ParticleMotion(
        const Array3& position, const Array3& velocity, const Array3 gradient[3], int i) {
        for (int a = 0; a < 3; ++a) {
            x[a] = position(i, a);
            u[a] = velocity(i, a);
            for (int k = 0; k < 3; ++k) c[a][k] = gradient[a](i, k);
        }
    }
    // The same particle in a turn about an axis through the origin, 1 rad/s.
    KOKKOS_INLINE_FUNCTION ParticleMotion turning(int axis) const {
        ParticleMotion out = *this;
        const int b = (axis + 1) % 3, d = (axis + 2) % 3;
        for (int a = 0; a < 3; ++a) {
            out.u[a] = 0;
            for (int k = 0; k < 3; ++k) out.c[a][k] = 0;
        }
        out.u[b] = -x[d];
        out.u[d] = x[b];
        out.c[b][d] = -1;
        out.c[d][b] = 1;
        return out;
    }
    // Adds its angular momentum about the origin, with what the affine velocity carries: the moment of what the particle gives to
    // the faces around it (apic.hpp).
    KOKKOS_INLINE_FUNCTION void add_angular_momentum(const MacGrid& grid, double mass, double sum[3]) const {
        for (int a = 0; a < 3; ++a) {
            const int b = (a + 1) % 3, d = (a + 2) % 3;
            sum[a] += mass * (x[b] * u[d] - x[d] * u[b]);
        }
        // Component a varies by c[a][k] along axis k; the weights' second moment there is s (1 - s) dx^2.
        for (int a = 0; a < grid.dimensions; ++a) {
            for (int k = 0; k < grid.dimensions; ++k) {
                if (k == a) continue;
                const double coordinate = (x[k] - grid.lower[k]) / grid.dx - 0.5;
                const double s = coordinate - math::floor(coordinate);
                const double moment = mass * s * (1 - s) * grid.dx * grid.dx * c[a][k];
                sum[3 - a - k] += (k + 1) % 3 == a ? moment : -moment;
            }
        }
    }
};

} // namespace treacle::grid
