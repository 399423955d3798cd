#pragma once
#include "grid/mac/particle_momentum.hpp"
#include "grid/momentum/momentum_scene.hpp"
#include "kokkos/types.hpp"

namespace treacle::grid {

// Numbers of a set of particles that its motion as one rigid body is found from, about the origin: momentum [kg m/s], angular
// momentum [kg m2/s], mass [kg], mass times place [kg m], and the angular momentum of unit spins about each axis through the
// origin [kg m2], by columns; and the angular momentum that was kept for each particle.
struct MomentumSums {
    static constexpr int count = 22, angular = 3, mass = 6, moment = 7, turn = 10, kept = 19;
    double of[count]{};
};

// Motion as one rigid body, which particles are given: the velocity of the origin [m/s] and the spin [rad/s].
struct RigidMotion {
    double velocity[3]{}, spin[3]{};
};

// Particles for sums over them.
struct MomentumParticles {
    MacGrid grid;
    Array3 x, u, c[3], kept;
    Array<int> liquid;
    Array<double> mass; // [liquids] [kg]

    MomentumParticles() = default;
    MomentumParticles(const MomentumScene& scene)
        : grid(scene.grid), x(scene.particles.position()),
          u(scene.particles.velocity()), c{scene.particles.affine(0), scene.particles.affine(1),
                                             scene.particles.affine(2)},
          kept(scene.kept), liquid(scene.particles.liquid()), mass(scene.particle_mass) {}
    // Adds particle i to sums [MomentumSums::count].
    KOKKOS_INLINE_FUNCTION void add(int i, double* sum) const {
        const double m = mass(liquid(i));
        const ParticleMotion moves(x, u, c, i);
        for (int k = 0; k < 3; ++k) {
            sum[k] += m * moves.u[k];
            sum[MomentumSums::moment + k] += m * moves.x[k];
            sum[MomentumSums::kept + k] += kept(i, k);
        }
        moves.add_angular_momentum(grid, m, sum + MomentumSums::angular);
        sum[MomentumSums::mass] += m;
        for (int axis = 0; axis < 3; ++axis)
            moves.turning(axis).add_angular_momentum(grid, m, sum + MomentumSums::turn + 3 * axis);
    }
    // Keeps the angular momentum of particle i.
    KOKKOS_INLINE_FUNCTION void keep(int i) const {
        double sum[3] = {0, 0, 0};
        ParticleMotion(x, u, c, i).add_angular_momentum(grid, mass(liquid(i)), sum);
        for (int k = 0; k < 3; ++k) kept(i, k) = sum[k];
    }
    // Adds a rigid motion to the velocity and affine velocities of particle i.
    KOKKOS_INLINE_FUNCTION void move(int i, const RigidMotion& motion) const {
        for (int a = 0; a < grid.dimensions; ++a) {
            const int b = (a + 1) % 3, d = (a + 2) % 3;
            u(i, a) += motion.velocity[a] + motion.spin[b] * x(i, d) - motion.spin[d] * x(i, b);
            c[a](i, d) += motion.spin[b];
            c[a](i, b) -= motion.spin[d];
        }
    }
};

} // namespace treacle::grid
