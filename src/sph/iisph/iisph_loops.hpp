#pragma once
#include "kokkos/float4.hpp"
#include "sph/iisph/iisph.hpp"

#include <cstdint>

namespace treacle::sph {

// A solid bears liquid if its normal is nearer to the vertical than this sine away from the horizontal.
constexpr double least_slope = 0.2;

// m grad W of the pairs, in single precision: a product reads 16 bytes a pair and is as long as these take to come.
struct Gradients {
    Array<float> x, y, z; // [entries of the list] [kg/m4]

    // Gradients of as many pairs as there are SIMD elements [kg/m4].
    struct Near {
        SimdDouble x, y, z; // in double precision
    };
    // Gradients of the pairs from entry k of the list on; lanes beyond the end of the row hold others.
    KOKKOS_INLINE_FUNCTION Near near(std::int64_t k) const {
        return {load_lanes(x.data() + k), load_lanes(y.data() + k), load_lanes(z.data() + k)};
    }
};

// g, the diagonal, which rows are watched, the gradients.
template <class Kernel>
struct PairLoop {
    Kernel kernel;
    Fluid fluid;
    bool bearing;      // only rows above solids are watched
    double gravity[3]; // [m/s2]
    RelativeDensity relative;
    Gradients gradients;
    Array<double> diagonal, watched; // [owned] [kg2/m8], 1 or 0
    Array3 own, force;               // [owned][3] g, and g with the factor of the walls' part [kg/m4]

    // True when solids, whose part of g is g - liquid, are below.
    KOKKOS_INLINE_FUNCTION bool bears(const double g[3], const double liquid[3]) const {
        double along = 0, square = 0, pull = 0;
        for (int k = 0; k < 3; ++k) {
            const double wall = g[k] - liquid[k];
            along += gravity[k] * wall;
            square += wall * wall;
            pull += gravity[k] * gravity[k];
        }
        return along > 0 && along * along > least_slope * least_slope * square * pull;
    }

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Constants& c = fluid.constants;
        const Row row = fluid.row(i);
        const std::int64_t first = fluid.liquid.offset(i);
        SimdDouble square = 0.0, gx = 0.0, gy = 0.0, gz = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto d = row.near(k);
            const auto along = distance(d.r2);
            const SimdDouble gradient = row.within(k, c.mass * kernel.gradient(along.r, along.inverse));
            const SimdDouble x = rounded(gradient * d.x), y = rounded(gradient * d.y), z = rounded(gradient * d.z);
            store_floats(x, row.count - k, gradients.x.data() + first + k);
            store_floats(y, row.count - k, gradients.y.data() + first + k);
            store_floats(z, row.count - k, gradients.z.data() + first + k);
            square = square + (x * x + y * y + z * z);
            gx = gx + x;
            gy = gy + y;
            gz = gz + z;
        }
        const double liquid[3] = {sum_lanes(gx), sum_lanes(gy), sum_lanes(gz)};
        double g[3] = {liquid[0], liquid[1], liquid[2]};
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double gradient = c.rest_density * fluid.solid_volume(s) * kernel.gradient(math::sqrt(r2));
            g[0] += gradient * dx;
            g[1] += gradient * dy;
            g[2] += gradient * dz;
        });
        for (int k = 0; k < 3; ++k) {
            own(i, k) = g[k];
            force(i, k) = liquid[k] + c.wall_pressure_factor * (g[k] - liquid[k]);
        }
        watched(i) = !bearing || bears(g, liquid) ? 1 : 0;
        diagonal(i) = (sum_lanes(square) + g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) / relative(i);
    }
};

// Source b of Iisph::prepare(), by its aim.
template <class Kernel>
struct SourceLoop {
    Kernel kernel;
    Fluid fluid;
    double dt; // [s]
    Iisph::Aim aim;
    double needed; // neighbours
    double slack;  // [kg/m3] of Aim::approach
    RelativeDensity relative;
    Gradients gradients;
    Array<double> density, source, diagonal; // [owned] [kg/m3], b [kg/m3/s2], of A [kg2/m8]

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Constants& c = fluid.constants;
        const auto &u = fluid.velocity, &v = fluid.solid_velocity;
        const double ux = u(i, 0), uy = u(i, 1), uz = u(i, 2);
        const Row row = fluid.row(i);
        const std::int64_t first = fluid.liquid.offset(i);
        SimdDouble divergence = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto w = fluid.motions(row, k);
            const auto g = gradients.near(first + k);
            divergence = divergence + row.within(k, g.x * (ux - w.x) + g.y * (uy - w.y) + g.z * (uz - w.z));
        }
        double change = sum_lanes(divergence);
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double gradient = c.rest_density * fluid.solid_volume(s) * kernel.gradient(math::sqrt(r2));
            const double along[3] = {gradient * dx, gradient * dy, gradient * dz};
            double g[3];
            fluid.correction.towards_solid(i, s, along, g);
            const double factor = fluid.carries(s) ? 1 : 0;
            change += (ux - factor * v(s, 0)) * g[0] + (uy - factor * v(s, 1)) * g[1] + (uz - factor * v(s, 2)) * g[2];
        });
        if (aim != Iisph::Aim::divergence) {
            const double excess = density(i) / relative(i) - c.rest_density;
            source(i) = ((aim == Iisph::Aim::approach ? math::min(excess + slack, 0.0) : excess) + dt * change) /
                        (dt * dt); // (2.4)
        } else {
            source(i) = change / dt;
            if (row.count + fluid.solid.count(i) < needed) diagonal(i) = 0;
        }
    }
};

// q -> a, of the owned and ghost particles' `load`.
struct AccelerationLoop {
    Fluid fluid;
    RelativeDensity relative;
    Array<int> inlet;           // of each particle, or empty
    Gradients adjoint;          // m B_j grad W, or as they are
    Array3 force, acceleration; // [owned][3] PairLoop::force [kg/m4], a [m/s2]

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Row row = fluid.row(i);
        const std::int64_t first = fluid.liquid.offset(i);
        SimdDouble fx = 0.0, fy = 0.0, fz = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const SimdDouble q = row.within(k, gather_lanes(fluid.load.data(), load_ints(row.index + k)));
            const auto g = adjoint.near(first + k);
            fx = fx + q * g.x;
            fy = fy + q * g.y;
            fz = fz + q * g.z;
        }
        const double q = fluid.load(i);
        const double sum[3] = {sum_lanes(fx), sum_lanes(fy), sum_lanes(fz)};
        const bool prescribed = inlet.size() > 0 && inlet(i) > 0;
        const double inverse_density = prescribed ? 0 : 1 / relative(i);
        for (int k = 0; k < 3; ++k) {
            const double a = inverse_density * (-q * force(i, k) - sum[k]);
            acceleration(i, k) = a;
            fluid.motion(i, k) = a;
        }
    }
};

// a -> A q; a_j is `motion`.
struct DensityChangeLoop {
    Fluid fluid;
    Gradients gradients;
    Array3 own;            // [owned][3] g [kg/m4]
    Array<double> product; // [owned] A q [kg/m3/s2]

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Row row = fluid.row(i);
        const std::int64_t first = fluid.liquid.offset(i);
        SimdDouble sum = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto a = fluid.motions(row, k);
            const auto g = gradients.near(first + k);
            sum = sum + row.within(k, a.x * g.x + a.y * g.y + a.z * g.z);
        }
        double out = sum_lanes(sum);
        for (int k = 0; k < 3; ++k) out -= fluid.motion(i, k) * own(i, k);
        product(i) = out;
    }
};

} // namespace treacle::sph
