#include "sph/iisph/correct_gradients.hpp"

#include "sph/model/symmetric.hpp"

#include <cstdint>

namespace treacle::sph {

namespace {
// Smallest eigenvalues of M below which gradients are those of the kernel, and above which they are corrected: at a free surface
// M is a half across it, and its inverse is noise in splashes.
constexpr double uncorrected_below = 0.25, corrected_above = 0.4;
// Share of the correction beside solids: in whole it drives liquid up along walls, with a half of it down.
constexpr double weight_beside_solids = 0.85;

KOKKOS_INLINE_FUNCTION void read(const Array<float> from[3], std::int64_t k, double g[3]) {
    for (int l = 0; l < 3; ++l) g[l] = from[l](k);
}

// Adds the symmetric part of g d^T.
KOKKOS_INLINE_FUNCTION void add_product(const double g[3], const double d[3], Symmetric& to) {
    to.xx += g[0] * d[0];
    to.yy += g[1] * d[1];
    to.zz += g[2] * d[2];
    to.xy += 0.5 * (g[0] * d[1] + g[1] * d[0]);
    to.xz += 0.5 * (g[0] * d[2] + g[2] * d[0]);
    to.yz += 0.5 * (g[1] * d[2] + g[2] * d[1]);
}

// Weight that the inverse of M may have, 0 to 1, by its smallest eigenvalue.
KOKKOS_INLINE_FUNCTION double trust(const Symmetric& m) {
    if (surely_above(m, corrected_above)) return 1;
    const Eigen3 e = eigen(m);
    const double least = math::min(e.value[0], math::min(e.value[1], e.value[2]));
    return math::min(math::max((least - uncorrected_below) / (corrected_above - uncorrected_below), 0.0), 1.0);
}

// B of the owned particles.
template <class Kernel>
struct CorrectionLoop {
    Kernel kernel;
    Fluid fluid;
    Array<float> gradient[3];

    // M of correct_gradients(), with the gradients of the kernel.
    KOKKOS_INLINE_FUNCTION Symmetric moment(int i) const {
        const Constants& c = fluid.constants;
        Symmetric m;
        std::int64_t pair = fluid.liquid.offset(i);
        fluid.liquid.each(i, [&](int, double dx, double dy, double dz, double) {
            double g[3];
            read(gradient, pair++, g);
            const double d[3] = {dx, dy, dz};
            add_product(g, d, m);
        });
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const auto& n = fluid.correction.normal;
            const double f = c.rest_density * fluid.solid_volume(s) * kernel.gradient(math::sqrt(r2)) *
                             GradientCorrection::wall_factor;
            const double height = n(s, 0) * dx + n(s, 1) * dy + n(s, 2) * dz - c.wall_depth;
            const double g[3] = {f * dx, f * dy, f * dz};
            const double d[3] = {height * n(s, 0), height * n(s, 1), height * n(s, 2)};
            add_product(g, d, m);
        });
        const double scale = -1 / c.rest_density;
        m = {scale * m.xx, scale * m.yy, scale * m.zz, scale * m.xy, scale * m.xz, scale * m.yz};
        if (Kernel::dimensions == 2) m.zz = 1, m.xz = 0, m.yz = 0;
        return m;
    }

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Symmetric m = moment(i);
        const double weight = trust(m), s = weight * (fluid.solid.count(i) > 0 ? weight_beside_solids : 1);
        fluid.correction.weight(i) = weight;
        Symmetric b{1, 1, 1, 0, 0, 0};
        if (s > 0) {
            const Symmetric v = inverse(m);
            b = {1 - s + s * v.xx, 1 - s + s * v.yy, 1 - s + s * v.zz, s * v.xy, s * v.xz, s * v.yz};
        }
        const auto &diagonal = fluid.correction.diagonal, &off = fluid.correction.off_diagonal;
        diagonal(i, 0) = b.xx, diagonal(i, 1) = b.yy, diagonal(i, 2) = b.zz;
        off(i, 0) = b.xy, off(i, 1) = b.xz, off(i, 2) = b.yz;
    }
};

// The gradients, their sum and the diagonal.
template <class Kernel>
struct GradientLoop {
    Kernel kernel;
    Fluid fluid;
    RelativeDensity relative;
    Array<float> own[3], adjoint[3];
    Array3 sum;
    Array<double> diagonal;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Constants& c = fluid.constants;
        double total[3] = {0, 0, 0}, square = 0;
        for (std::int64_t k = fluid.liquid.offset(i); k < fluid.liquid.offset(i + 1); ++k) {
            double g[3], mine[3], theirs[3];
            read(own, k, g);
            fluid.correction.times(i, g, mine);
            fluid.correction.times(fluid.liquid.index(k), g, theirs);
            for (int l = 0; l < 3; ++l) {
                own[l](k) = static_cast<float>(mine[l]);
                adjoint[l](k) = static_cast<float>(theirs[l]);
                total[l] += own[l](k);
                square += double(own[l](k)) * own[l](k);
            }
        }
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double f = c.rest_density * fluid.solid_volume(s) * kernel.gradient(math::sqrt(r2));
            const double g[3] = {f * dx, f * dy, f * dz};
            double push[3];
            fluid.correction.towards_solid(i, s, g, push);
            for (int l = 0; l < 3; ++l) total[l] += push[l];
        });
        for (int l = 0; l < 3; ++l) {
            sum(i, l) = total[l];
            square += total[l] * total[l];
        }
        diagonal(i) = square / relative(i);
    }
};
} // namespace

void correct_gradients(const StepContext& parts, const CorrectedGradients& gradients) {
    auto& liquid = parts.liquid;
    const auto fluid = make_views(parts.constants, liquid, parts.solid, parts.neighbours);
    const auto &own = gradients.own, &adjoint = gradients.adjoint;
    with_kernel(parts.options.kernel, parts.constants.dimensions, parts.constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for("treacle::gradient_corrections", fluid.count,
            CorrectionLoop<Kernel>{kernel, fluid, {own[0], own[1], own[2]}});
        parts.halo.gather(liquid.store, {liquid.correction_diagonal_field(), liquid.correction_off_diagonal_field()});
        Kokkos::parallel_for("treacle::corrected_gradients", fluid.count,
            GradientLoop<Kernel>{kernel, fluid, relative_density(parts.constants, liquid), {own[0], own[1], own[2]},
                {adjoint[0], adjoint[1], adjoint[2]}, gradients.sum, gradients.diagonal});
    });
}

} // namespace treacle::sph
