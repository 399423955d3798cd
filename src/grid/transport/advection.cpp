#include "grid/transport/advection.hpp"

#include "flow/sides.hpp"
#include "grid/mac/small_matrix.hpp"

namespace treacle::grid {

DomainSides make_domain_sides(const MacGrid& grid, const scene::Domain& domain) {
    DomainSides out{periodic_box(grid), {}, grid.dimensions};
    for (std::size_t k = 0; k < 3; ++k) {
        if (out.period[k] == 0) out.lo[k] = domain.min[k], out.hi[k] = domain.max[k];
        for (std::size_t s = 2 * k; s < 2 * k + 2; ++s) out.open[s] = flow::beyond(domain.faces[s]);
    }
    return out;
}

namespace {
// Place that x is carried to in dt by the velocity u there, of the share `bent` along the velocities of the faces.
KOKKOS_INLINE_FUNCTION void trace(
    const FaceSampler& faces, const double x[3], const double u[3], double bent, double dt, double to[3]) {
    if (!(bent > 0)) {
        for (int c = 0; c < 3; ++c) to[c] = x[c] + dt * u[c];
        return;
    }
    double stage[3], later[3];
    for (int c = 0; c < 3; ++c) stage[c] = x[c] + 2.0 / 3 * bent * dt * u[c];
    faces.velocity(stage, later);
    for (int c = 0; c < 3; ++c) to[c] = x[c] + dt * (0.25 * u[c] + 0.75 * later[c]);
}

// The gradient after particles have moved by it, no larger than before: liquid that nothing surrounds would make it
// grow from step to step.
KOKKOS_INLINE_FUNCTION SmallMatrix carry(const SmallMatrix& gradient, double dt) {
    auto carried = carried_gradient(gradient, dt);
    const double before = gradient.squares(), after = carried.squares();
    if (!(after > before)) return carried;
    const double factor = math::sqrt(before / after);
    for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) carried.at[a][b] *= factor;
    }
    return carried;
}

// `distance` to the solids there.
KOKKOS_INLINE_FUNCTION LossCause loss_of(
    const Advection& how, double leak_depth, double distance, const double x[3], const double u[3]) {
    for (int k = 0; k < 3; ++k) {
        if (!math::isfinite(x[k]) || !math::isfinite(u[k])) return LossCause::non_finite;
    }
    if (how.outlets.take(x)) return LossCause::outflow;
    for (int k = 0; k < how.domain.dimensions; ++k) {
        if (how.domain.period[k] > 0) {
            // Farther than one period in one step: a step gone wrong.
            if (x[k] < how.domain.lo[k] || x[k] > how.domain.hi[k]) return LossCause::leak;
            continue;
        }
        const double beyond[2] = {how.domain.lo[k] - x[k], x[k] - how.domain.hi[k]};
        for (int s = 0; s < 2; ++s) {
            if (how.domain.open[2 * k + s] && beyond[s] > 0) return LossCause(how.domain.open[2 * k + s]);
            if (!how.domain.open[2 * k + s] && beyond[s] > leak_depth) return LossCause::leak;
        }
    }
    return distance < -leak_depth ? LossCause::leak : LossCause::none;
}
} // namespace

DepartureCounts advect(const Advection& how, const GridParticles& particles, double dt) {
    const auto x = particles.position(), u = particles.velocity();
    const auto cause = particles.cause();
    const auto ux = particles.affine(0), uy = particles.affine(1), uz = particles.affine(2);
    const double width = how.faces.width, clearance = how.options.clearance * width,
                 leak = how.options.leak_depth * width;
    DepartureCounts out;
    Kokkos::parallel_reduce(
        "treacle::advect", particles.store.owned(),
        KOKKOS_LAMBDA(int i, int& lost, int& outflow, int& projected_out) {
            const double from[3] = {x(i, 0), x(i, 1), x(i, 2)};
            const double speed[3] = {u(i, 0), u(i, 1), u(i, 2)};
            SmallMatrix gradient;
            for (int k = 0; k < 3; ++k) {
                gradient.at[0][k] = ux(i, k);
                gradient.at[1][k] = uy(i, k);
                gradient.at[2][k] = uz(i, k);
            }
            double to[3];
            trace(how.faces, from, speed, bending_weight(gradient, dt), dt, to);
            const auto carried = carry(gradient, dt);
            for (int k = 0; k < 3; ++k) {
                ux(i, k) = carried.at[0][k];
                uy(i, k) = carried.at[1][k];
                uz(i, k) = carried.at[2][k];
            }
            auto found = LossCause::none;
            if (math::isfinite(to[0]) && math::isfinite(to[1]) && math::isfinite(to[2])) {
                double start[3];
                how.bodies.carry(i, how.solid, from, start);
                // The window goes on beyond a periodic side, but need not hold what lies at the other one.
                const double end[3] = {to[0], to[1], to[2]};
                projected_out += walk(how.solid, clearance, start, end, to) ? 1 : 0;
                const double distance = how.solid.at(to);
                for (int k = 0; k < 3; ++k) to[k] = how.domain.wrap(k, to[k]);
                found = loss_of(how, leak, distance, to, speed);
            } else {
                found = LossCause::non_finite;
            }
            for (int k = 0; k < 3; ++k) x(i, k) = to[k];
            cause(i) = static_cast<int>(found);
            outflow += found == LossCause::outflow ? 1 : 0;
            lost += found != LossCause::none && found != LossCause::outflow ? 1 : 0;
        },
        out.lost, out.outflow, out.projected_out);
    return out;
}

namespace {
// Losses are rare and each one is reported: the host checks all particles of this rank.
std::vector<LostParticle> list_lost(const GridParticles& particles) {
    std::vector<LostParticle> lost;
    const auto x = on_host(particles.position()), u = on_host(particles.velocity());
    const auto id = on_host(particles.id());
    const auto cause = on_host(particles.cause());
    for (int i = 0; i < particles.store.owned(); ++i) {
        const auto why = LossCause(cause(i));
        if (why == LossCause::none || why == LossCause::outflow) continue;
        lost.push_back({id(i), {x(i, 0), x(i, 1), x(i, 2)}, {u(i, 0), u(i, 1), u(i, 2)}, why});
    }
    return lost;
}
} // namespace

std::vector<LostParticle> remove_departed(GridParticles& particles) {
    const int n = particles.store.owned();
    const auto cause = particles.cause();
    const Array<int> keep("treacle::keep", static_cast<std::size_t>(n));
    int kept = 0, outflow = 0;
    Kokkos::parallel_scan(
        "treacle::remove_departed", n,
        KOKKOS_LAMBDA(int i, int& sum, bool last) {
            const bool stays = cause(i) == static_cast<int>(LossCause::none);
            if (last && stays) keep(sum) = i;
            sum += static_cast<int>(stays);
        },
        kept);
    Kokkos::parallel_reduce(
        "treacle::count_outflow", n,
        KOKKOS_LAMBDA(int i, int& sum) { sum += static_cast<int>(cause(i) == static_cast<int>(LossCause::outflow)); },
        outflow);
    std::vector<LostParticle> lost;
    if (kept + outflow < n) lost = list_lost(particles);
    particles.store.permute(keep, kept);
    return lost;
}

} // namespace treacle::grid
