#include "sph/surface_tension/surface_tension.hpp"

#include "sph/model/moment_reference_points.hpp"
#include "sph/model/symmetric.hpp"
#include "sph/surface_tension/surface_lattice.hpp"

#include <cmath>

namespace treacle::sph {

namespace {
// Coefficients by which particles are kept apart: s, c over d, and of the damping. Cohesion draws neighbours together with 5
// sigma/(rho0 d^2).
struct Distance {
    double strength, cutoff, damping;
};
constexpr Distance distance_of(SurfaceTensionModel model) {
    return model == SurfaceTensionModel::cohesion ? Distance{30, 1, 0} : Distance{1, 0.9, 1};
}
// Fraction of the capillary limit, for cohesion, whose forces on a particle are several times sigma/(rho0 d^2).
constexpr double cohesion_factor = 0.2;

// Pair forces over the first liquid's mass, into `acceleration`, or added to it.
template <class Kernel>
struct PairLoop {
    Kernel kernel;
    Pairs pairs;
    double cohesion, repulsion, cutoff, damping;
    RelativeDensity relative;
    Array3 velocity, acceleration;

    // Damping of the pair's relative velocity along x, over |x| [1/s2].
    KOKKOS_INLINE_FUNCTION double damped(int i, int j, const Kokkos::Array<double, 3>& x) const {
        if (damping == 0) return 0; // the ghosts' velocities are those of before
        double along = 0, square = 1e-6 * cutoff * cutoff;
        for (std::size_t k = 0; k < 3; ++k) {
            along += (velocity(i, k) - velocity(j, k)) * x[k];
            square += x[k] * x[k];
        }
        return damping * along / square;
    }

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        double a[3] = {0, 0, 0};
        pairs.each(i, [&](int j, double dx, double dy, double dz, double r2) {
            const double r = math::sqrt(r2);
            double f = cohesion > 0 ? -cohesion * kernel.value(r) : 0;
            if (r < cutoff)
                f += repulsion * (1 - r / cutoff) / math::max(r, 1e-3 * cutoff) - damped(i, j, {dx, dy, dz});
            a[0] += f * dx;
            a[1] += f * dy;
            a[2] += f * dz;
        });
        for (int k = 0; k < 3; ++k) acceleration(i, k) += a[k] / relative(i);
    }
};

void set_curvature_forces(
    const SurfaceCurvature& surface, const LiquidParticles& liquid, const RelativeDensity& relative, double scale) {
    const double lift = surface.lift();
    const auto normal = surface.normal(liquid), a = liquid.acceleration();
    const auto curvature = surface.curvature(liquid), delta = surface.delta(liquid);
    Kokkos::parallel_for(
        "treacle::surface_tension", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            const double size = row_length(normal, i);
            const double k = curvature(i), raised = math::min(1.5, math::max(0.5, 1 + lift * k));
            const double f = size > 0 ? scale * k * delta(i) * raised / (size * relative(i)) : 0;
            for (int axis = 0; axis < 3; ++axis) a(i, axis) = f * normal(i, axis);
        });
}

// Sums over the particles of the surface, w = |N|, all over the first liquid's mass.
struct BalanceLoop : LoadReduction {
    enum Sum { force, weight = 3, weighted_position, contacts = 7, torque, inertia = 11, sums = 17 };
    Array3 position, normal, acceleration;
    Pairs solid;
    RelativeDensity relative;
    double centre[3];

    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        const double w = row_length(normal, i);
        if (w == 0) return;
        const double m = relative(i), a[3] = {acceleration(i, 0), acceleration(i, 1), acceleration(i, 2)};
        const double x[3] = {position(i, 0) - centre[0], position(i, 1) - centre[1], position(i, 2) - centre[2]};
        const double square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
        for (int k = 0; k < 3; ++k) {
            const int l = (k + 1) % 3, n = (k + 2) % 3;
            sum[force + k] += m * a[k];
            sum[weighted_position + k] += m * w * x[k];
            sum[torque + k] += m * (x[l] * a[n] - x[n] * a[l]);
            sum[inertia + k] += m * w * (square - x[k] * x[k]); // xx, yy, zz
            sum[inertia + 3 + k] -= m * w * x[l] * x[n];        // yz, xz, xy
        }
        sum[weight] += m * w;
        sum[contacts] += solid.count(i) > 0 ? 1 : 0;
    }
};

std::vector<double> surface_sums(
    const StepContext& parts, const SurfaceCurvature& surface, const std::array<double, 3>& centre) {
    const auto& liquid = parts.liquid;
    std::vector<double> sums(BalanceLoop::sums, 0.0);
    const BalanceLoop loop{{sums.size()}, liquid.position(), surface.normal(liquid), liquid.acceleration(),
        pairs(parts.neighbours.solid, liquid.store, parts.solid.store), relative_density(parts.constants, liquid),
        {centre[0], centre[1], centre[2]}};
    Kokkos::parallel_reduce("treacle::surface_sums", liquid.store.owned(), loop, host_sums(sums));
    parts.comm.sum(std::span(sums));
    return sums;
}

// Takes off the accelerations what their forces and, where `turns`, their torques add up to.
void balance(const StepContext& parts, const SurfaceCurvature& surface, bool turns) {
    using Sums = BalanceLoop;
    auto sums = surface_sums(parts, surface, {0, 0, 0});
    const double weight = sums[Sums::weight];
    if (parts.comm.any(parts.liquid.has_inlets()) || sums[Sums::contacts] > 0 || weight == 0) return;
    std::array<double, 3> centre{};
    for (std::size_t k = 0; k < 3; ++k) centre[k] = sums[Sums::weighted_position + k] / weight;
    sums = surface_sums(parts, surface, centre);
    double push[3], turn[3] = {0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k) push[k] = sums[Sums::force + k] / weight;
    if (turns) {
        const double* a = &sums[Sums::inertia];
        const Symmetric inertia{a[0], a[1], a[2], a[5], a[4], a[3]};
        const auto inverse =
            truncated_pseudo_inverse(inertia, 1e-9 * (a[0] + a[1] + a[2])); // none about the axis of a row
        inverse.times(&sums[Sums::torque], turn);
    }
    const auto x = parts.liquid.position(), n = surface.normal(parts.liquid), out = parts.liquid.acceleration();
    const double cx = centre[0], cy = centre[1], cz = centre[2];
    const double px = push[0], py = push[1], pz = push[2], tx = turn[0], ty = turn[1], tz = turn[2];
    Kokkos::parallel_for(
        "treacle::balance_surface", parts.liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            const double w = row_length(n, i);
            const double rx = x(i, 0) - cx, ry = x(i, 1) - cy, rz = x(i, 2) - cz;
            out(i, 0) -= w * (px + ty * rz - tz * ry);
            out(i, 1) -= w * (py + tz * rx - tx * rz);
            out(i, 2) -= w * (pz + tx * ry - ty * rx);
        });
}
} // namespace

SurfaceTension::SurfaceTension(LiquidParticles& liquid, const SphOptions& options, const Constants& constants,
    const DomainBox& domain, double tension)
    : tension_(tension), conserves_torque_(domain.period[0] == 0 && domain.period[1] == 0 && domain.period[2] == 0) {
    if (options.surface_tension.model == SurfaceTensionModel::curvature) {
        curvature_.emplace(liquid, options, constants);
    } else {
        cohesion_ =
            tension / cohesion_energy({options.kernel, constants.dimensions, constants.support, constants.spacing});
    }
}

void SurfaceTension::accelerate(const StepContext& parts, double dt) {
    const auto& c = parts.constants;
    const auto relative = relative_density(c, parts.liquid);
    const auto a = parts.liquid.acceleration(), u = parts.liquid.velocity();
    const int count = parts.liquid.store.owned();
    if (curvature_) {
        curvature_->measure(parts);
        set_curvature_forces(*curvature_, parts.liquid, relative, tension_ / c.rest_density);
        balance(parts, *curvature_, conserves_torque_);
    } else {
        Kokkos::deep_copy(a, 0.0);
    }
    const auto apart = distance_of(parts.options.surface_tension.model);
    const double stiffness = tension_ / (c.rest_density * c.spacing * c.spacing); // [m/s2]
    if (apart.damping > 0) parts.halo.gather(parts.liquid.store, {parts.liquid.velocity_field()});
    with_kernel(parts.options.kernel, c.dimensions, c.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for("treacle::surface_pairs", count,
            PairLoop<Kernel>{kernel, pairs(parts.neighbours.liquid, parts.liquid.store, parts.liquid.store),
                cohesion_ * c.rest_volume * c.rest_volume / c.mass, apart.strength * stiffness,
                apart.cutoff * c.spacing, apart.damping * std::sqrt(stiffness / c.spacing), relative, u, a});
    });
    Kokkos::parallel_for(
        "treacle::accelerate_surface", count, KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) u(i, k) += dt * a(i, k);
        });
}

double capillary_step_limit(const SurfaceTensionOptions& options, const Constants& constants, double tension) {
    if (options.model == SurfaceTensionModel::none) return 1e300;
    const double d = constants.spacing, factor = options.model == SurfaceTensionModel::cohesion ? cohesion_factor : 1;
    return factor * constants.immiscible.time_step_factor *
           std::sqrt(constants.rest_density * d * d * d / (4 * math::pi * tension));
}

} // namespace treacle::sph
