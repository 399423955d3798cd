#include "sph/surface_tension/surface_curvature.hpp"

#include "sph/surface_tension/surface_lattice.hpp"

namespace treacle::sph {

namespace {
constexpr int normal_passes = 3; // fewer leave the steps of a lattice in the curvatures (src/sph/theory.md)
constexpr int curvature_passes = 2;
constexpr int delta_passes =
    1; // none: the steps of the lattice are in the forces; more: they lie deeper below the surface
constexpr double delta_support = 0.8; // a over h: deeper particles of the surface are still within h
constexpr double least_normal = 0.1;  // |N| h below which a particle is none of the surface

KOKKOS_INLINE_FUNCTION double length(const double v[3]) { return math::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
template <class Kernel>
struct NormalLoop {
    Kernel kernel;
    Fluid fluid;
    Array3 normal;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        double n[3] = {0, 0, 0}, wall[3] = {0, 0, 0};
        fluid.liquid.each(i, [&](int, double dx, double dy, double dz, double r2) {
            const double g = fluid.constants.rest_volume * kernel.gradient(math::sqrt(r2));
            n[0] += g * dx;
            n[1] += g * dy;
            n[2] += g * dz;
        });
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double g = fluid.solid_volume(s) * kernel.gradient(math::sqrt(r2));
            wall[0] += g * dx;
            wall[1] += g * dy;
            wall[2] += g * dz;
        });
        const double square = wall[0] * wall[0] + wall[1] * wall[1] + wall[2] * wall[2];
        const double along = square > 0 ? (n[0] * wall[0] + n[1] * wall[1] + n[2] * wall[2]) / square : 0;
        for (int k = 0; k < 3; ++k) normal(i, k) = n[k] - along * wall[k];
    }
};

template <class Kernel>
struct SmoothNormalLoop {
    Kernel kernel;
    Pairs pairs;
    Array3 from, to;
    double least; // [1/m]; what is shorter becomes 0

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const double own = kernel.value(0.0);
        double weights = own, n[3] = {own * from(i, 0), own * from(i, 1), own * from(i, 2)};
        pairs.each(i, [&](int j, double, double, double, double r2) {
            const double w = kernel.value(math::sqrt(r2));
            weights += w;
            for (int k = 0; k < 3; ++k) n[k] += w * from(j, k);
        });
        const double scale = length(n) < least * weights ? 0 : 1 / weights;
        for (int k = 0; k < 3; ++k) to(i, k) = scale * n[k];
    }
};

template <class Kernel>
struct CurvatureLoop {
    Kernel kernel;
    Pairs pairs;
    Array3 normal;
    Array<double> curvature;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        curvature(i) = 0;
        const double size = row_length(normal, i);
        if (size == 0) return;
        const double n[3] = {normal(i, 0) / size, normal(i, 1) / size, normal(i, 2) / size}; // inwards
        double turned = 0, across = 0;
        pairs.each(i, [&](int j, double dx, double dy, double dz, double r2) {
            const double other = row_length(normal, j);
            if (other == 0) return;
            const double w = -other * kernel.gradient(math::sqrt(r2)), d[3] = {dx, dy, dz};
            double along = 0, turn = 0;
            for (int k = 0; k < 3; ++k) {
                along += n[k] * d[k];
                turn += (normal(j, k) / other - n[k]) * d[k];
            }
            turned += w * turn;
            across += w * (r2 - along * along);
        });
        if (across > 0) curvature(i) = (Kernel::dimensions - 1) * turned / across;
    }
};

template <class Kernel>
struct SmoothCurvatureLoop {
    Kernel kernel;
    Pairs pairs;
    Array3 normal;
    Array<double> from, to;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        to(i) = 0;
        const double size = row_length(normal, i);
        if (size == 0) return;
        double weights = size * kernel.value(0.0), sum = weights * from(i);
        pairs.each(i, [&](int j, double, double, double, double r2) {
            const double w = kernel.value(math::sqrt(r2)) * row_length(normal, j);
            weights += w;
            sum += w * from(j);
        });
        to(i) = sum / weights;
    }
};

// |N| of owned particles and ghosts.
void write_strength(const LiquidParticles& liquid, const Array3& normal, const Array<double>& strength) {
    Kokkos::parallel_for(
        "treacle::surface_strength", liquid.store.total(),
        KOKKOS_LAMBDA(int i) { strength(i) = row_length(normal, i); });
}

// (S4t) delta, from the strength |N'|.
struct DeltaLoop {
    Pairs pairs;
    Array3 normal;
    Array<double> strength, delta;
    double unit;    // V0 c [m]
    double support; // a [m]

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        delta(i) = 0;
        const double size = row_length(normal, i);
        if (size == 0) return;
        const double n[3] = {normal(i, 0) / size, normal(i, 1) / size, normal(i, 2) / size};
        double sum = strength(i);
        pairs.each(i, [&](int j, double dx, double dy, double dz, double r2) {
            if (n[0] * normal(j, 0) + n[1] * normal(j, 1) + n[2] * normal(j, 2) <= 0) return;
            const double across = n[0] * dx + n[1] * dy + n[2] * dz;
            const double rest = 1 - (r2 - across * across) / (support * support);
            if (rest > 0) sum += rest * rest * strength(j);
        });
        delta(i) = sum > 0 ? strength(i) / (unit * sum) : 0;
    }
};

// From curvatures at a depth below the surface to those of the surface; `depth` over D - 1 [m].
void raise(const Array<double>& curvature, int count, double depth) {
    Kokkos::parallel_for(
        "treacle::raise_curvature", count,
        KOKKOS_LAMBDA(int i) { curvature(i) /= 1 + math::max(-0.5, depth * curvature(i)); });
}
} // namespace

SurfaceCurvature::SurfaceCurvature(LiquidParticles& liquid, const SphOptions& options, const Constants& constants) {
    normal_[0] = liquid.store.add<Array3>("surface_normal", "1/m", FieldRole::work);
    normal_[1] = liquid.store.add<Array3>("smooth_surface_normal", "1/m", FieldRole::work);
    curvature_[0] = liquid.store.add<Array<double>>("curvature", "1/m", FieldRole::work);
    curvature_[1] = liquid.store.add<Array<double>>("smooth_curvature", "1/m", FieldRole::work);
    strength_ = liquid.store.add<Array<double>>("surface_strength", "1/m", FieldRole::work);
    delta_ = liquid.store.add<Array<double>>("surface_delta", "1/m", FieldRole::work);
    const SurfaceSetup setup{options.kernel, constants.dimensions, constants.support, constants.spacing};
    depth_ = surface_depth(setup, normal_passes);
    lift_ = surface_depth(setup, delta_passes) / (2 * (constants.dimensions - 1));
}

const Array3& SurfaceCurvature::normal(const LiquidParticles& liquid) const {
    return liquid.store.get<Array3>(normal_[last_normal_]);
}

const Array<double>& SurfaceCurvature::curvature(const LiquidParticles& liquid) const {
    return liquid.store.get<Array<double>>(curvature_[last_curvature_]);
}

const Array<double>& SurfaceCurvature::delta(const LiquidParticles& liquid) const {
    return liquid.store.get<Array<double>>(delta_);
}

void SurfaceCurvature::measure(const StepContext& parts) {
    const auto& c = parts.constants;
    auto& liquid = parts.liquid;
    auto& halo = parts.halo;
    const auto fluid = make_views(c, liquid, parts.solid, parts.neighbours);
    const auto& around = fluid.liquid;
    with_kernel(parts.options.kernel, c.dimensions, c.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        last_normal_ = last_curvature_ = 0;
        Kokkos::parallel_for(
            "treacle::surface_normals", fluid.count, NormalLoop<Kernel>{kernel, fluid, normal(liquid)});
        halo.gather(liquid.store, {normal_[0]});
        for (int pass = 1; pass <= normal_passes; ++pass) {
            const auto from = normal(liquid);
            last_normal_ = 1 - last_normal_;
            const double least = pass < normal_passes ? 0 : least_normal / c.support;
            Kokkos::parallel_for("treacle::smooth_normals", fluid.count,
                SmoothNormalLoop<Kernel>{kernel, around, from, normal(liquid), least});
            halo.gather(liquid.store, {normal_[last_normal_]});
            if (pass == delta_passes)
                write_strength(liquid, normal(liquid), liquid.store.get<Array<double>>(strength_));
        }
        Kokkos::parallel_for("treacle::curvature", fluid.count,
            CurvatureLoop<Kernel>{kernel, around, normal(liquid), curvature(liquid)});
        for (int pass = 0; pass < curvature_passes; ++pass) {
            halo.gather(liquid.store, {curvature_[last_curvature_]});
            const auto from = curvature(liquid);
            last_curvature_ = 1 - last_curvature_;
            Kokkos::parallel_for("treacle::smooth_curvature", fluid.count,
                SmoothCurvatureLoop<Kernel>{kernel, around, normal(liquid), from, curvature(liquid)});
        }
    });
    raise(curvature(liquid), fluid.count, depth_ / (c.dimensions - 1));
    const double a = delta_support * c.support;
    const double norm = c.dimensions == 2 ? 15 / (16 * a) : 3 / (math::pi * a * a);
    Kokkos::parallel_for("treacle::surface_delta", fluid.count,
        DeltaLoop{around, normal(liquid), liquid.store.get<Array<double>>(strength_), delta(liquid),
            c.rest_volume * norm, a});
}

} // namespace treacle::sph
