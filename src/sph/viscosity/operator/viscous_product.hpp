#pragma once
#include "kokkos/float4.hpp"
#include "sph/viscosity/operator/viscous_loops.hpp"

// Loops of a product with the viscous operator in double precision.
namespace treacle::sph {

// Velocity gradients G_i = N_i B_i^+, and of them Q_i = dt/m V (2 mu S_i B_i^+ - kappa mu G_i).
template <class Kernel>
struct StressLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    double damping;                    // kappa [1]
    bool by_volumes;                   // of the neighbours, as the published form has it
    Array<double> viscous_coefficient; // [particles] dt/m V mu [m2]
    Array6 correction;
    Array3 stress[3]; // columns of Q [m2/s]
    bool rated;
    Array<double> rate;               // [owned] shear rate [1/s]
    Array<float> bulk;                // zeta / mu of each particle [1], or empty
    Array<double> tension, expansion; // s / mu, or empty; tr D, with `bulk` [1/s]

    KOKKOS_INLINE_FUNCTION void operator()(int block) const {
        each_row<Columns>(
            block, Base::fluid.count, [&](int i) { return sum_pairs(i); },
            [&](int i, const Columns& pairs) { finish(i, pairs); });
    }

private:
    struct Columns {
        Double4 column[3];
    };
    KOKKOS_INLINE_FUNCTION void finish(int i, const Columns& pairs) const {
        double n[3][3];
        for (int l = 0; l < 3; ++l) {
            double column[4];
            pairs.column[l].store(column);
            for (int k = 0; k < 3; ++k) n[k][l] = column[k];
        }
        double u[3];
        Base::read_velocity(i, u);
        Base::add_wall_gradients(i, u, n);
        const Symmetric fit = read_symmetric(correction, i), spanned = range_projector(fit);
        double g[3][3];
        for (int k = 0; k < 3; ++k) fit.times(n[k], g[k]);
        double s[3][3];
        strain(spanned, g, s);
        if (rated || tension.size() > 0) rate(i) = math::sqrt(2 * contract(s));
        if (bulk.size() > 0) resist_expansion(i, spanned, s);
        const double c = viscous_coefficient(i);
        for (int k = 0; k < 3; ++k) {
            double q[3];
            fit.times(s[k], q);
            for (int l = 0; l < 3; ++l) {
                stress[l](i, k) = c * (2 * q[l] - damping * g[k][l]);
            }
        }
    }
    // S + (zeta tr S + s)/(2 mu) within the span.
    KOKKOS_INLINE_FUNCTION void resist_expansion(int i, const Symmetric& span, double s[3][3]) const {
        const double trace = s[0][0] + s[1][1] + s[2][2];
        if (tension.size() > 0) expansion(i) = trace;
        if (bulk(i) == 0) return;
        const double more = 0.5 * (static_cast<double>(bulk(i)) * trace + (tension.size() > 0 ? tension(i) : 0));
        const double within[3][3] = {
            {span.xx, span.xy, span.xz}, {span.xy, span.yy, span.yz}, {span.xz, span.yz, span.zz}};
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) s[k][l] += more * within[k][l];
        }
    }
    KOKKOS_INLINE_FUNCTION static double contract(const double s[3][3]) {
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) sum += s[k][l] * s[k][l];
        }
        return sum;
    }
    KOKKOS_INLINE_FUNCTION Columns sum_pairs(int i) const {
        const double *packed_position = Base::fluid.packed_position.data(), *motion = Base::fluid.motion.data();
        const Double4 x = Double4::load(packed_position + 4 * std::int64_t(i)),
                      u = Double4::load(motion + 4 * std::int64_t(i));
        Double4 even[3] = {0.0, 0.0, 0.0}, odd[3] = {0.0, 0.0, 0.0};
        Base::each_entry(i, even, odd, [&](Double4 columns[3], std::int64_t k) {
            const double* other = motion + 4 * std::int64_t(Base::fluid.liquid.index(k));
            const double w = by_volumes ? Base::weights(k) * other[3] : Base::weights(k);
            const Double4 along =
                Double4(w) * (x - Double4::load(packed_position + 4 * std::int64_t(Base::fluid.liquid.index(k))));
            const Double4 apart = u - Double4::load(other);
            columns[0].add(along.all<0>(), apart);
            columns[1].add(along.all<1>(), apart);
            columns[2].add(along.all<2>(), apart);
        });
        return {{even[0] + odd[0], even[1] + odd[1], even[2] + odd[2]}};
    }
};

// C u of the forms with gradients.
template <class Kernel>
struct StressForceLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    double damping; // kappa [1]
    RelativeDensity relative;
    Array<double> viscous_coefficient; // [particles] dt/m V mu [m2]
    Array3 stress[3];                  // columns of Q [m2/s]
    Array3 product;                    // C u [m/s]

    KOKKOS_INLINE_FUNCTION void operator()(int block) const {
        each_row<Double4>(
            block, Base::fluid.count, [&](int i) { return sum_pairs(i); },
            [&](int i, const Double4& pairs) { finish(i, pairs); });
    }

private:
    KOKKOS_INLINE_FUNCTION void finish(int i, const Double4& pairs) const {
        double u[3], f[4];
        Base::read_velocity(i, u);
        pairs.store(f);
        Base::add_wall_stresses(
            i, WallStressForce<Stresses>{{stress[0], stress[1], stress[2]}, viscous_coefficient, damping}, u, f);
        const double inertia = relative(i);
        for (int k = 0; k < 3; ++k) product(i, k) = inertia * u[k] + f[k];
    }
    // The fourth ones of `packed_position` are the viscous coefficients dt/m V mu, of which `damping` acts on differences of velocities.
    KOKKOS_INLINE_FUNCTION Double4 sum_pairs(int i) const {
        const double *packed_position = Base::fluid.packed_position.data(), *motion = Base::fluid.motion.data();
        const auto read = [](const double* rows, int row) { return Double4::load(rows + 4 * std::int64_t(row)); };
        const Double4 x = read(packed_position, i), u = read(motion, i);
        const Double4 twice = 2 * Base::fluid.packed_position(i, 3), factor = damping;
        const Double4 own[3] = {Double4::load(stress[0], i), Double4::load(stress[1], i), Double4::load(stress[2], i)};
        struct Sums {
            Double4 pull[3] = {0.0, 0.0, 0.0}, slide = 0.0, spread = 0.0;
        } even, odd;
        Base::each_entry(i, even, odd, [&](Sums& sums, std::int64_t k) {
            const int j = Base::fluid.liquid.index(k);
            const Double4 w = static_cast<double>(Base::weights(k)), apart = x - read(packed_position, j);
            const Double4 along = w * apart;
            sums.spread.add(w, apart);
            sums.pull[0].add(along.all<0>(), Double4::load(stress[0], j));
            sums.pull[1].add(along.all<1>(), Double4::load(stress[1], j));
            sums.pull[2].add(along.all<2>(), Double4::load(stress[2], j));
            sums.slide.add(w * twice - along.all<3>(), u - read(motion, j));
        });
        const Double4 spread = even.spread + odd.spread;
        Double4 sum = factor * (even.slide + odd.slide);
        for (int l = 0; l < 3; ++l) sum = sum + even.pull[l] + odd.pull[l];
        sum.add(spread.all<0>(), own[0]);
        sum.add(spread.all<1>(), own[1]);
        sum.add(spread.all<2>(), own[2]);
        return sum;
    }
};

// C u of the forms by pairs: along the line between two particles, or the Laplacian of each component.
template <class Kernel>
struct PairForceLoop : ViscousLoop<Kernel> {
    using Base = ViscousLoop<Kernel>;
    RelativeDensity relative;
    WallPairForce wall_force;
    Array3 product; // C u [m/s]

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        double u[3];
        Base::read_velocity(i, u);
        const double soft = wall_force.soft, line = wall_force.line, own = wall_force.viscous_coefficient(i);
        const Row row = Base::fluid.row(i);
        const std::int64_t first = Base::fluid.liquid.offset(i);
        SimdDouble fx = 0.0, fy = 0.0, fz = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto d = row.near(k);
            const auto v = Base::fluid.motions(row, k);
            const SimdDouble w = row.within(k, load_lanes(&Base::weights(first + k)));
            const SimdDouble c = w * (own + d.number) * treacle::inverse(d.r2 + soft);
            const SimdDouble ax = u[0] - v.x, ay = u[1] - v.y, az = u[2] - v.z;
            if (line > 0) {
                const SimdDouble pull = line * c * (ax * d.x + ay * d.y + az * d.z);
                fx = fx + pull * d.x;
                fy = fy + pull * d.y;
                fz = fz + pull * d.z;
            } else {
                fx = fx + c * d.r2 * ax;
                fy = fy + c * d.r2 * ay;
                fz = fz + c * d.r2 * az;
            }
        }
        double f[3] = {sum_lanes(fx), sum_lanes(fy), sum_lanes(fz)};
        Base::add_walls(i, wall_force, u, f);
        const double inertia = relative(i);
        for (int k = 0; k < 3; ++k) product(i, k) = inertia * u[k] + f[k];
    }
};

} // namespace treacle::sph
