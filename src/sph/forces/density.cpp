#include "sph/forces/density.hpp"

namespace treacle::sph {

namespace {
template <class Kernel>
struct DensityLoop {
    Kernel kernel;
    NumberKernel number;
    DensityOptions options;
    Fluid fluid;
    RelativeDensity relative;
    Array<double> density, blended, volume;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Constants& c = fluid.constants;
        double rho = c.mass * kernel.value(0.0);
        const Row row = fluid.row(i);
        SimdDouble around = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            around = around + row.within(k, kernel.value(distance(row.near(k).r2).r)); // (2.1)
        }
        rho += c.mass * sum_lanes(around);
        double wall = 0, wall_number = 0;
        fluid.solid.each(i, [&](int s, double, double, double, double r2) {
            const double r = math::sqrt(r2);
            wall += fluid.solid_volume(s) * kernel.value(r);
            wall_number += fluid.solid_volume(s) * number.value(r);
        });
        rho += c.rest_density * wall;
        const double weight = relative(i);
        density(i) = weight * rho;
        volume(i) = c.mass / rho;
        const double zeta = options.spiky_weight(fluid.solid.count(i)); // (2.3)
        if (zeta == 0) {
            blended(i) = weight * rho;
            return;
        }
        SimdDouble spiky = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            spiky = spiky + row.within(k, number.value(distance(row.near(k).r2).r)); // (2.2)
        }
        const double n = sum_lanes(spiky) + wall_number / c.rest_volume;
        blended(i) = weight * ((1 - zeta) * rho + zeta * c.rest_density / c.number_density * n);
    }
};

template <class Kernel>
struct SolidVolumeLoop {
    Kernel kernel;
    Pairs solids;
    MomentReferencePoints points;
    double packing; // of solids that rest
    Array<int> body;
    Array<double> volume;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        double sum = kernel.value(0.0);
        const int own = body(i);
        solids.each(i, [&](int s, double, double, double, double r2) {
            if (body(s) != own && (points.moves(own) || points.moves(body(s)))) return;
            sum += kernel.value(math::sqrt(r2));
        });
        volume(i) = (points.moves(own) ? points.scale(own) : packing) / sum;
    }
};
} // namespace

double wall_packing(const PressureOptions& options, int dimensions) {
    if (!options.recovers_positions()) return 1;
    return dimensions == 3 ? 1.08 : 1.06;
}

void compute_density(const SphOptions& options, const Constants& constants, LiquidParticles& liquid,
    const SolidParticles& solid, const Neighbourhood& neighbours) {
    pack_positions(liquid, liquid.pressure());
    const auto fluid = make_views(constants, liquid, solid, neighbours);
    const NumberKernel number(constants.support, constants.spacing);
    with_kernel(options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for("treacle::density", fluid.count,
            DensityLoop<Kernel>{kernel, number, options.density, fluid, relative_density(constants, liquid),
                liquid.density(), liquid.blended_density(), liquid.volume()});
    });
}

void compute_solid_volumes(const SphOptions& options, const Constants& constants, SolidParticles& solid,
    const NeighbourList& list, const MomentReferencePoints& points) {
    with_kernel(options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for("treacle::solid_volumes", solid.store.owned(),
            SolidVolumeLoop<Kernel>{kernel, pairs(list, solid.store, solid.store), points, constants.wall_packing,
                solid.body(), solid.volume()});
    });
}

Compression measure_compression(const Constants& constants, const LiquidParticles& liquid) {
    Compression out;
    const auto rho = liquid.density();
    const double rest = constants.rest_density;
    const auto relative = relative_density(constants, liquid);
    Kokkos::parallel_reduce(
        "treacle::compression", liquid.store.owned(),
        KOKKOS_LAMBDA(int i, double& sum, double& most) {
            const double error = math::max(0.0, rho(i) / (rest * relative(i)) - 1);
            sum += error;
            most = math::max(most, error);
        },
        Kokkos::Sum<double>(out.sum), Kokkos::Max<double>(out.max));
    if (liquid.store.owned() == 0) out.max = 0;
    return out;
}

} // namespace treacle::sph
