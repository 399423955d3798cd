#pragma once
#include "sph/model/pair_softening.hpp"
#include "sph/viscosity/operator/viscous_operator.hpp"

// What the loops of the viscous operator share.
namespace treacle::sph {

// True for the forms with gradients, whose stresses a product leaves for the neighbours.
KOKKOS_INLINE_FUNCTION bool by_gradients(ViscosityForm form) {
    return form == ViscosityForm::corrected || form == ViscosityForm::adjoint || form == ViscosityForm::as_published;
}

// Copies the velocities of a field, ghosts included, and volumes over the lattice's, to where the loops read them.
void pack_velocity(LiquidParticles& liquid, int u_field, const Constants& constants);

// Particles that sum over their neighbours one after the other, and then make of their sums what they are for: a long chain of
// operations each, of which the processor then has several going at once.
inline constexpr int rows_at_once = lanes > 1 ? 8 : 1;
constexpr int row_blocks(int rows) { return (rows + rows_at_once - 1) / rows_at_once; }

// Rows of a block: sum(i) of all of them, then finish(i, sums).
template <class Sums, class Sum, class Finish>
KOKKOS_INLINE_FUNCTION void each_row(int block, int count, const Sum& sum, const Finish& finish) {
    const int first = rows_at_once * block, last = math::min(first + rows_at_once, count);
    Sums sums[rows_at_once];
    for (int i = first; i < last; ++i) sums[i - first] = sum(i);
    for (int i = first; i < last; ++i) finish(i, sums[i - first]);
}

// What every loop reads; `place` has the shares dt/m V mu, `motion` the velocities.
template <class Kernel>
struct ViscousLoop {
    Kernel kernel;
    Fluid fluid;
    ViscousWalls walls;
    Array<float> weights; // V0 |W'|/r of each pair in the list [1/m2]
    // Sums over the no-slip solids of w beta x and, in the last column, w beta^2, for the forms with gradients: all that
    // solids at rest put into a product. None goes through them again then.
    Array4 wall_sums;

    // visit(w, j, dx, dy, dz, r2) for the liquid particles around i.
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void each_pair(int i, const Visit& visit) const {
        std::int64_t k = fluid.liquid.offset(i);
        fluid.liquid.each(i, [&](int j, double dx, double dy, double dz, double r2) {
            visit(static_cast<double>(weights(k++)), j, dx, dy, dz, r2);
        });
    }
    // The list and its weights are read once a product, faster than the hardware prefetches by itself: prefetches those
    // of the row after the next.
    KOKKOS_INLINE_FUNCTION void read_ahead(int i) const {
        constexpr int row_ahead = 64, line = 16; // in entries
        const std::int64_t last = fluid.liquid.offset(i + 1);
        for (int ahead = row_ahead; ahead < row_ahead + 3 * line; ahead += line) {
            prefetch(fluid.liquid.index.data() + last + ahead);
            prefetch(weights.data() + last + ahead);
        }
    }
    // visit(sums, k) for the list's entries around i, even and odd ones apart, since each addition depends on the one
    // before.
    template <class Sums, class Visit>
    KOKKOS_INLINE_FUNCTION void each_entry(int i, Sums& even, Sums& odd, const Visit& visit) const {
        read_ahead(i);
        const std::int64_t last = fluid.liquid.offset(i + 1);
        std::int64_t k = fluid.liquid.offset(i);
        for (; k + 1 < last; k += 2) {
            visit(even, k);
            visit(odd, k + 1);
        }
        if (k < last) visit(even, k);
    }
    KOKKOS_INLINE_FUNCTION double weight(double volumes, double r2) const {
        return -volumes * kernel.gradient(math::sqrt(r2));
    }
    // visit(s, w, dx, dy, dz, contact) for the no-slip solid particles, with V_s |W'|/r [1/m2].
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void each_wall(int i, const Visit& visit) const {
        walls.pairs.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            if (!walls.no_slip(s)) return;
            visit(s, weight(walls.viscous_factor * walls.volume(s), r2), dx, dy, dz, walls.touch(s, dx, dy, dz));
        });
    }
    template <class WallForce>
    KOKKOS_INLINE_FUNCTION void add_walls(int i, const WallForce& wall_force, const double u[3], double sum[3]) const {
        each_wall(i, [&](int, double w, double dx, double dy, double dz, const auto& contact) {
            const double x[3] = {dx, dy, dz};
            double force[3];
            wall_force(i, w, x, u, contact, force);
            for (int k = 0; k < 3; ++k) sum[k] += force[k];
        });
    }
    // Sums for the forms with gradients: of w (u_i - u_j) x^T, added to N, and to C u.
    KOKKOS_INLINE_FUNCTION void add_wall_gradients(int i, const double u[3], double n[3][3]) const {
        if (walls.pairs.count(i) == 0) return;
        if (walls.resting) {
            for (int k = 0; k < 3; ++k) {
                for (int l = 0; l < 3; ++l) n[k][l] += u[k] * wall_sums(i, l);
            }
            return;
        }
        each_wall(i, [&](int, double w, double dx, double dy, double dz, const auto& contact) {
            const double x[3] = {dx, dy, dz};
            for (int k = 0; k < 3; ++k) {
                const double difference = w * contact.beta * (u[k] - contact.velocity[k]);
                for (int l = 0; l < 3; ++l) n[k][l] += difference * x[l];
            }
        });
    }
    template <class WallForce>
    KOKKOS_INLINE_FUNCTION void add_wall_stresses(
        int i, const WallForce& wall_force, const double u[3], double sum[3]) const {
        if (walls.pairs.count(i) == 0) return;
        if (walls.resting)
            wall_force.add(i, wall_sums, u, sum);
        else
            add_walls(i, wall_force, u, sum);
    }
    KOKKOS_INLINE_FUNCTION void read_velocity(int i, double u[3]) const {
        for (int k = 0; k < 3; ++k) u[k] = fluid.motion(i, k);
    }
};

// Columns l of Q_i, as the products in double and in single precision leave them.
struct Stresses {
    Array3 column[3]; // [particles][3] [m2/s]
    KOKKOS_INLINE_FUNCTION double operator()(int i, int k, int l) const { return column[l](i, k); }
};
struct TileStresses {
    Array16 tiles;
    KOKKOS_INLINE_FUNCTION double operator()(int i, int k, int l) const { return tiles(i, 4 * l + k); }
};

// What one solid particle adds to a row of C u, or all of them at rest.
template <class Stress>
struct WallStressForce {
    Stress stress;
    Array<double> viscous_coefficient; // [particles] dt/m V mu [m2]
    double damping;                    // kappa [1]

    template <class Contact>
    KOKKOS_INLINE_FUNCTION void operator()(
        int i, double w, const double x[3], const double u[3], const Contact& contact, double out[3]) const {
        for (int k = 0; k < 3; ++k) {
            const double pull = stress(i, k, 0) * x[0] + stress(i, k, 1) * x[1] + stress(i, k, 2) * x[2];
            const double slide = damping * viscous_coefficient(i) * contact.beta * (u[k] - contact.velocity[k]);
            out[k] = w * contact.beta * (pull + slide);
        }
    }
    // All contacts of particle i with solids at rest at once, by its ViscousLoop::wall_sums.
    KOKKOS_INLINE_FUNCTION void add(int i, const Array4& sums, const double u[3], double out[3]) const {
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) out[k] += stress(i, k, l) * sums(i, l);
            out[k] += damping * viscous_coefficient(i) * sums(i, 3) * u[k];
        }
    }
};
// Pull of one solid particle in the forms with forces along the pairs.
struct WallPairForce {
    Array<double> viscous_coefficient; // [particles] dt/m V mu [m2]
    double soft, line;                 // see pair_softening(); D + 2 for the pairwise form, 0 for the Laplacian

    template <class Contact>
    KOKKOS_INLINE_FUNCTION void operator()(
        int i, double w, const double x[3], const double u[3], const Contact& contact, double out[3]) const {
        const double r2 = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
        const double c = 2 * viscous_coefficient(i) * w * contact.beta / (r2 + soft);
        double along = 0;
        for (int k = 0; k < 3; ++k) along += (u[k] - contact.velocity[k]) * x[k];
        for (int k = 0; k < 3; ++k) {
            out[k] = c * (line > 0 ? line * along * x[k] : r2 * (u[k] - contact.velocity[k]));
        }
    }
};

// Pull of the form that the options name.
inline WallPairForce wall_pair_force(const ViscousContext& parts, const Array<double>& viscous_coefficient) {
    const double line = parts.options.viscosity.form == ViscosityForm::pairwise ? parts.constants.dimensions + 2 : 0;
    return {viscous_coefficient, pair_softening(parts.constants.support), line};
}

} // namespace treacle::sph
