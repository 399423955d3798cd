#include "sph/forces/motion.hpp"

#include <cmath>

namespace treacle::sph {

namespace {
template <class Vectors>
KOKKOS_INLINE_FUNCTION LossCause loss_of(const DomainBox& domain, const Vectors& x, const Vectors& u, int i) {
    for (int k = 0; k < 3; ++k) {
        if (!math::isfinite(x(i, k)) || !math::isfinite(u(i, k))) return LossCause::non_finite;
    }
    for (int k = 0; k < domain.dimensions; ++k) {
        if (domain.period[k] > 0) {
            // Farther than one period in one step: a step gone wrong.
            if (x(i, k) < domain.lo[k] || x(i, k) >= domain.hi[k]) return LossCause::leak;
            continue;
        }
        const double below = domain.lo[k] - x(i, k), above = x(i, k) - domain.hi[k];
        if (below > (domain.open[2 * k] ? 0 : domain.leak_depth)) {
            return domain.open[2 * k] ? LossCause(domain.open[2 * k]) : LossCause::leak;
        }
        if (above > (domain.open[2 * k + 1] ? 0 : domain.leak_depth)) {
            return domain.open[2 * k + 1] ? LossCause(domain.open[2 * k + 1]) : LossCause::leak;
        }
    }
    return LossCause::none;
}

// True when a point within the domain and a finite velocity need no further test; not so for NaN.
KOKKOS_INLINE_FUNCTION bool clearly_inside(const DomainBox& domain, const double x[3], const double u[3]) {
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
        const bool within = k < domain.dimensions ? x[k] >= domain.lo[k] && x[k] < domain.hi[k] : x[k] - x[k] == 0.0;
        inside = inside && within && u[k] - u[k] == 0.0;
    }
    return inside;
}
} // namespace

DepartureCounts move_particles(const DomainBox& domain, LiquidParticles& liquid, double dt, Use use_correction) {
    const auto x = liquid.position(), u = liquid.velocity(), correction = liquid.acceleration();
    const double factor = use_correction == Use::yes ? 1 : 0;
    DepartureCounts out;
    Kokkos::parallel_reduce(
        "treacle::move", liquid.store.owned(),
        KOKKOS_LAMBDA(int i, int& lost, int& outflow) {
            double to[3], speed[3];
            for (int k = 0; k < 3; ++k) {
                speed[k] = u(i, k);
                const double extra = factor > 0 ? correction(i, k) : 0;
                to[k] = domain.wrap(k, x(i, k) + dt * (speed[k] + extra));
                x(i, k) = to[k];
            }
            if (clearly_inside(domain, to, speed)) return;
            const auto cause = loss_of(domain, x, u, i);
            outflow += static_cast<int>(cause == LossCause::outflow);
            lost += static_cast<int>(cause != LossCause::none && cause != LossCause::outflow);
        },
        out.lost, out.outflow);
    return out;
}

std::vector<LostParticle> remove_lost(const DomainBox& domain, LiquidParticles& liquid) {
    std::vector<LostParticle> lost;
    // Losses are rare and each one is reported: the host checks all particles of this rank.
    const auto x = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), liquid.position());
    const auto u = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), liquid.velocity());
    const auto id = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), liquid.id());
    const int n = liquid.store.owned();
    std::vector<LossCause> causes(static_cast<std::size_t>(n), LossCause::none);
    const Array<int> keep("treacle::keep", static_cast<std::size_t>(n));
    auto host_keep = Kokkos::create_mirror_view(keep);
    int kept = 0;
    for (int i = 0; i < n; ++i) {
        const auto cause = loss_of(domain, x, u, i);
        if (cause == LossCause::none) {
            host_keep(kept++) = i;
        } else {
            lost.push_back({id(i), {x(i, 0), x(i, 1), x(i, 2)}, {u(i, 0), u(i, 1), u(i, 2)}, cause});
        }
    }
    if (lost.empty()) return lost;
    Kokkos::deep_copy(keep, host_keep);
    liquid.store.permute(keep, kept);
    return lost;
}

namespace {
// Momentum and angular momentum of this rank's particles, over the mass of one of relative density 1.
std::array<double, 6> sum_momentum(const LiquidParticles& liquid, const Constants& constants, const Array3& velocity) {
    const auto x = liquid.position(), u = velocity;
    const auto relative = relative_density(constants, liquid);
    double p[3] = {0, 0, 0}, l[3] = {0, 0, 0};
    Kokkos::parallel_reduce(
        "treacle::momentum", liquid.store.owned(),
        KOKKOS_LAMBDA(int i, double& px, double& py, double& pz, double& lx, double& ly, double& lz) {
            const double m = relative(i);
            px += m * u(i, 0);
            py += m * u(i, 1);
            pz += m * u(i, 2);
            lx += m * (x(i, 1) * u(i, 2) - x(i, 2) * u(i, 1));
            ly += m * (x(i, 2) * u(i, 0) - x(i, 0) * u(i, 2));
            lz += m * (x(i, 0) * u(i, 1) - x(i, 1) * u(i, 0));
        },
        p[0], p[1], p[2], l[0], l[1], l[2]);
    return {p[0], p[1], p[2], l[0], l[1], l[2]};
}
} // namespace

std::array<double, 6> measure_momentum(
    const Comm& comm, const LiquidParticles& liquid, const Constants& constants, const Array3& velocity) {
    auto out = sum_momentum(liquid, constants, velocity);
    comm.sum(std::span<double>(out));
    for (double& sum : out) sum *= constants.mass;
    return out;
}

LiquidTotals measure_totals(const Comm& comm, const LiquidParticles& liquid, const Constants& constants,
    const std::array<double, 3>& gravity, const Array3& velocity) {
    const auto x = liquid.position(), u = velocity;
    const auto relative = relative_density(constants, liquid);
    const double gx = gravity[0], gy = gravity[1], gz = gravity[2];
    double weight = 0, speed2 = 0, potential = 0, fastest = 0;
    const int n = liquid.store.owned();
    Kokkos::parallel_reduce(
        "treacle::energy", n,
        KOKKOS_LAMBDA(int i, double& mass, double& kinetic, double& height, double& most) {
            const double s2 = u(i, 0) * u(i, 0) + u(i, 1) * u(i, 1) + u(i, 2) * u(i, 2), m = relative(i);
            mass += m;
            kinetic += m * s2;
            height -= m * (gx * x(i, 0) + gy * x(i, 1) + gz * x(i, 2));
            most = math::max(most, s2);
        },
        weight, speed2, potential, Kokkos::Max<double>(fastest));
    const auto p = sum_momentum(liquid, constants, velocity);
    double sums[10] = {double(n), p[0], p[1], p[2], p[3], p[4], p[5], speed2, potential, weight};
    comm.sum(std::span<double>(sums));
    const double mass = constants.mass;
    LiquidTotals out;
    out.particles = static_cast<std::int64_t>(std::llround(sums[0]));
    out.mass = mass * sums[9];
    for (std::size_t k = 0; k < 3; ++k) {
        out.momentum[k] = mass * sums[1 + k];
        out.angular_momentum[k] = mass * sums[4 + k];
    }
    out.kinetic_energy = 0.5 * mass * sums[7];
    out.potential_energy = mass * sums[8];
    out.max_speed = std::sqrt(comm.max(n > 0 ? fastest : 0.0));
    return out;
}

} // namespace treacle::sph
