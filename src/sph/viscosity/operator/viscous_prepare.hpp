#pragma once
#include "sph/viscosity/operator/viscous_loops.hpp"

namespace treacle::sph {

// Directions in which the neighbours spread less than that share of the lattice's spread carry no stress: a thread of
// particles has a strain along it, a sheet in it.
inline constexpr double min_moment_eigenvalue = 0.02;

// The weights, B_i = sum V w x x^T, its inverse, and the blocks that precondition.
template <class Kernel>
struct PrepareLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    ViscosityForm form;
    double volume;  // V0 [m^D]
    double damping; // kappa [1]
    RelativeDensity relative;
    Array<double> viscous_coefficient; // [particles] dt/m V mu [m2]
    bool slips;
    Array<double> drag; // of walls along which the liquid slips
    bool has_inlets;
    Array<int> inlet;  // [particles] number of the inlet that moves it, 0: free
    Array<float> bulk; // over the viscosity, or empty
    Array6 correction;
    ViscousOperator::Blocks block;
    Array<float> inertia_and_wall_diagonal, smoothed_viscous_coefficient; // [owned] [1], [m2]

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        Symmetric fit{1, 1, 1, 0, 0, 0};
        double wall_sum = 0;                    // by the solids
        double around = viscous_coefficient(i); // mean coefficient of the neighbours, weighted by w r^2
        Symmetric d = by_gradients(form) ? stress_block(i, fit, wall_sum, around) : pair_block(i, wall_sum, around);
        write_symmetric(fit, correction, i);
        const double inertia = relative(i) + (slips ? drag(i) : 0);
        d.xx += inertia, d.yy += inertia, d.zz += inertia;
        write_symmetric(inverse(d), block, i);
        const bool prescribed = has_inlets && inlet(i) > 0;
        smoothed_viscous_coefficient(i) = static_cast<float>(0.5 * (viscous_coefficient(i) + around));
        inertia_and_wall_diagonal(i) =
            static_cast<float>(prescribed ? (d.xx + d.yy + d.zz) / 3 : inertia + 2 * viscous_coefficient(i) * wall_sum);
    }

private:
    // Writes V0 |W'|/r of the liquid around i, the same number for both particles of a pair, and visits some pairs at a time with
    // what was written, 0 beyond the row.
    template <class Visit>
    KOKKOS_INLINE_FUNCTION void weigh(int i, const Visit& visit) const {
        const Row row = Base::fluid.row(i);
        float* w = Base::weights.data() + Base::fluid.liquid.offset(i);
        for (int k = 0; k < row.count; k += lanes) {
            const auto near = row.near(k);
            const auto along = distance(near.r2);
            const SimdDouble weight = rounded(-volume * Base::kernel.gradient(along.r, along.inverse));
            store_floats(weight, row.count - k, w + k);
            visit(near, row.within(k, weight));
        }
    }
    // Over the neighbours of a particle.
    struct Sums {
        Symmetric spread, strained;             // w x x^T; s_j w^2 x x^T
        double damped = 0, pull[3] = {0, 0, 0}; // w (s_i + s_j); w x
        double weighted_coefficients = 0;       // s_j w r^2
    };
    KOKKOS_INLINE_FUNCTION Sums sum_row(int i) const {
        const double own = viscous_coefficient(i);
        SimdDouble n[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, m[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
        SimdDouble damped = 0.0, weighted_coefficients = 0.0, x = 0.0, y = 0.0, z = 0.0;
        weigh(i, [&](const Row::Near& d, SimdDouble f) {
            const SimdDouble g = d.number * f * f;
            const SimdDouble squares[6] = {d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.x * d.z, d.y * d.z};
            for (int e = 0; e < 6; ++e) {
                n[e] = n[e] + f * squares[e];
                m[e] = m[e] + g * squares[e];
            }
            damped = damped + f * (own + d.number);
            weighted_coefficients = weighted_coefficients + f * d.r2 * d.number;
            x = x + f * d.x;
            y = y + f * d.y;
            z = z + f * d.z;
        });
        const auto symmetric = [](const SimdDouble e[6]) {
            return Symmetric{
                sum_lanes(e[0]), sum_lanes(e[1]), sum_lanes(e[2]), sum_lanes(e[3]), sum_lanes(e[4]), sum_lanes(e[5])};
        };
        return {symmetric(n), symmetric(m), sum_lanes(damped), {sum_lanes(x), sum_lanes(y), sum_lanes(z)},
            sum_lanes(weighted_coefficients)};
    }
    // What the strains of the particle and of its neighbours put into its diagonal block. The neighbours' corrections are taken to
    // be like its own, which this finds.
    KOKKOS_INLINE_FUNCTION Symmetric stress_block(int i, Symmetric& fit, double& wall_sum, double& around) const {
        Sums sums = sum_row(i);
        const double weights = sums.spread.xx + sums.spread.yy + sums.spread.zz;
        if (weights > 0) around = sums.weighted_coefficients / weights;
        double wall[4] = {0, 0, 0, 0}; // see ViscousLoop::wall_sums
        Base::each_wall(i, [&](int, double w, double dx, double dy, double dz, const auto& contact) {
            const double beta = contact.beta, x[3] = {dx, dy, dz};
            sums.spread.add_square(w, dx, dy, dz);
            wall_sum += w * beta;
            for (int k = 0; k < 3; ++k) wall[k] += w * beta * x[k];
            wall[3] += w * beta * beta;
        });
        for (int k = 0; k < 4; ++k) Base::wall_sums(i, k) = wall[k];
        for (int k = 0; k < 3; ++k) sums.pull[k] += wall[k];
        sums.damped += 2 * viscous_coefficient(i) * wall[3];
        if (form == ViscosityForm::corrected) fit = truncated_pseudo_inverse(sums.spread, min_moment_eigenvalue);
        double own[3];
        fit.times(sums.pull, own);
        Symmetric d = enclosed(fit, sums.strained);
        const double c = viscous_coefficient(i), square = own[0] * own[0] + own[1] * own[1] + own[2] * own[2];
        const double both = d.xx + d.yy + d.zz + c * square + damping * sums.damped;
        const double once = bulk.size() > 0 ? 1 + static_cast<double>(bulk(i)) : 1;
        d.xx *= once, d.yy *= once, d.zz *= once, d.xy *= once, d.xz *= once, d.yz *= once;
        d.add_square(once * c, own[0], own[1], own[2]);
        d.xx += both, d.yy += both, d.zz += both;
        return d;
    }
    // What the pairs put there.
    KOKKOS_INLINE_FUNCTION Symmetric pair_block(int i, double& wall_sum, double& around) const {
        Symmetric d;
        double weights = 0, weighted_coefficients = 0;
        const double soft = pair_softening(Base::kernel.h);
        const auto pair = [&](double coefficients, double w, double dx, double dy, double dz, double r2) {
            if (form == ViscosityForm::pairwise) {
                d.add_square((Kernel::dimensions + 2) * coefficients * w / (r2 + soft), dx, dy, dz);
            } else {
                const double along = coefficients * w * r2 / (r2 + soft);
                d.xx += along, d.yy += along, d.zz += along;
            }
        };
        weigh(i, [](const Row::Near&, SimdDouble) {});
        Base::each_pair(i, [&](double w, int j, double dx, double dy, double dz, double r2) {
            pair(viscous_coefficient(i) + viscous_coefficient(j), w, dx, dy, dz, r2);
            weights += w * r2;
            weighted_coefficients += w * r2 * viscous_coefficient(j);
        });
        if (weights > 0) around = weighted_coefficients / weights;
        Base::each_wall(i, [&](int, double w, double dx, double dy, double dz, const auto& contact) {
            pair(2 * viscous_coefficient(i), w * contact.beta, dx, dy, dz, dx * dx + dy * dy + dz * dz);
            wall_sum += w * contact.beta;
        });
        return d;
    }
};

} // namespace treacle::sph
