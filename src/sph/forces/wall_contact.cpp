#include "sph/forces/wall_contact.hpp"

#include <cmath>

namespace treacle::sph {

namespace {
// A particle is over a solid particle when the normal through that one passes it within this many spacings:
// half the diagonal of the layer's squares, and a little.
constexpr double patch = 0.75;
// In a corner what one wall gives may lead into the other.
constexpr int passes = 2;

// Velocity of a particle: the part that contacts may change, and the rest, which may be empty [m/s].
struct Moves {
    Array3 changed, rest;
    KOKKOS_INLINE_FUNCTION double operator()(int i, int k) const {
        return changed(i, k) + (rest.size() > 0 ? rest(i, k) : 0.0);
    }
};

// Sums over the bodies as their loads are, and a last number: particles stopped.
struct WallContactLoop : LoadReduction {
    Fluid fluid;
    Moves moves;
    Array3 normal;
    MomentReferencePoints points;
    RelativeDensity relative;
    double dt;

    // The least velocity out of the solid with which a particle at this height over the layer ends the step
    // above the surface, or where it already is below it.
    KOKKOS_INLINE_FUNCTION double least_rise(double height) const {
        return math::min(0.0, (fluid.constants.wall_depth - height) / dt);
    }

    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        if (fluid.solid.count(i) == 0) return;
        const Constants& c = fluid.constants;
        const auto& v = fluid.solid_velocity;
        const double cutoff2 = patch * patch * c.spacing * c.spacing;
        const double position[3] = {fluid.solid.of(i, 0), fluid.solid.of(i, 1), fluid.solid.of(i, 2)};
        bool stopped = false;
        for (int pass = 0; pass < passes; ++pass) {
            fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
                const double n[3] = {normal(s, 0), normal(s, 1), normal(s, 2)};
                const double height = n[0] * dx + n[1] * dy + n[2] * dz;
                if (height < 0 || r2 - height * height > cutoff2) return;
                const double rise =
                    (moves(i, 0) - v(s, 0)) * n[0] + (moves(i, 1) - v(s, 1)) * n[1] + (moves(i, 2) - v(s, 2)) * n[2];
                const double push = least_rise(height) - rise;
                if (!(push > 0)) return;
                stopped = true;
                double force[3]; // on the solid [N]
                for (int k = 0; k < 3; ++k) {
                    moves.changed(i, k) += push * n[k];
                    force[k] = -c.mass * relative(i) * push * n[k] / dt;
                }
                points.add(sum + 6 * fluid.solid_body(s), fluid.solid_body(s), position, force);
            });
        }
        if (stopped) sum[value_count - 1] += 1;
    }
};

std::int64_t stop(
    const StepContext& parts, const Fluid& fluid, const Moves& moves, const WallStop& at, std::span<double> loads) {
    std::vector<double> sums(loads.size() + 1, 0.0);
    const WallContactLoop loop{{sums.size()}, fluid, moves, parts.solid.normal(), at.points,
        relative_density(parts.constants, parts.liquid), at.dt};
    Kokkos::parallel_reduce("treacle::stop_at_walls", fluid.count, loop, host_sums(sums));
    for (std::size_t k = 0; k < loads.size(); ++k) loads[k] += sums[k];
    return std::llround(sums.back());
}
} // namespace

std::int64_t stop_at_walls(const StepContext& parts, const WallStop& at, BodyLoads& loads) {
    if (parts.neighbours.solid.size == 0) return 0;
    const auto fluid = make_views(parts.constants, parts.liquid, parts.solid, parts.neighbours);
    return stop(parts, fluid, {fluid.velocity, {}}, at, loads);
}

void stop_shift_at_walls(const StepContext& parts, const WallStop& at, const Array3& shift) {
    if (parts.neighbours.solid.size == 0) return;
    const auto fluid = make_views(parts.constants, parts.liquid, parts.solid, parts.neighbours);
    BodyLoads unused(6 * static_cast<std::size_t>(at.points.count), 0.0); // a shift of places has no impulse
    stop(parts, fluid, {shift, fluid.velocity}, at, unused);
}

} // namespace treacle::sph
