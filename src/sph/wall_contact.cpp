#include "sph/wall_contact.hpp"

#include <cmath>

namespace treacle::sph {

namespace {
// A particle is over a solid particle when the normal through that one passes it within this many spacings:
// half the diagonal of the layer's squares, and a little.
constexpr double patch = 0.75;
// In a corner what one wall gives may lead into the other.
constexpr int passes = 2;

// Sums over the bodies as their loads are, and a last number: particles stopped.
struct WallContactLoop : LoadReduction {
    Fluid fluid;
    Array3 normal;
    LoadPoints points;
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
        const auto &u = fluid.velocity, &v = fluid.solid_velocity;
        const double reach2 = patch * patch * c.spacing * c.spacing;
        const double place[3] = {fluid.solid.of(i, 0), fluid.solid.of(i, 1), fluid.solid.of(i, 2)};
        bool stopped = false;
        for (int pass = 0; pass < passes; ++pass) {
            fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
                const double n[3] = {normal(s, 0), normal(s, 1), normal(s, 2)};
                const double height = n[0] * dx + n[1] * dy + n[2] * dz;
                if (height < 0 || r2 - height * height > reach2) return;
                const double rise =
                    (u(i, 0) - v(s, 0)) * n[0] + (u(i, 1) - v(s, 1)) * n[1] + (u(i, 2) - v(s, 2)) * n[2];
                const double push = least_rise(height) - rise;
                if (!(push > 0)) return;
                stopped = true;
                double force[3]; // on the solid [N]
                for (int k = 0; k < 3; ++k) {
                    u(i, k) += push * n[k];
                    force[k] = -c.mass * relative(i) * push * n[k] / dt;
                }
                points.add(sum + 6 * fluid.solid_body(s), fluid.solid_body(s), place, force);
            });
        }
        if (stopped) sum[value_count - 1] += 1;
    }
};
} // namespace

std::int64_t stop_at_walls(const Constants& constants, LiquidParticles& liquid, const SolidParticles& solid,
                           const Neighbourhood& neighbours, const WallStop& stop, BodyLoads& loads) {
    if (neighbours.solid.size == 0) return 0;
    const auto fluid = gather_fluid(constants, liquid, solid, neighbours);
    std::vector<double> sums(loads.size() + 1, 0.0);
    const WallContactLoop loop{
        {sums.size()}, fluid, solid.normal(), stop.points, relative_density(constants, liquid), stop.dt};
    Kokkos::parallel_reduce("treacle::stop_at_walls", fluid.count, loop, host_sums(sums));
    for (std::size_t k = 0; k < loads.size(); ++k) loads[k] += sums[k];
    return std::llround(sums.back());
}

} // namespace treacle::sph
