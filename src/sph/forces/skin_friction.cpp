#include "sph/forces/skin_friction.hpp"

#include <algorithm>

namespace treacle::sph {

namespace {
template <class Kernel>
struct SkinFrictionLoop : LoadReduction {
    Kernel kernel;
    Fluid fluid;
    MomentReferencePoints points;
    RelativeDensity relative;
    Array<double> coefficient;
    double dt;

    // Walls around a particle.
    struct Wall {
        double area[3] = {0, 0, 0};     // sum_s V_s grad W [1/m]
        double velocity[3] = {0, 0, 0}; // [m/s]
        double size = 0;                // of area
        double coefficient = 0;
        double weights = 0;
    };

    KOKKOS_INLINE_FUNCTION double weight(int s, double r2) const {
        return -fluid.solid_volume(s) / fluid.constants.wall_packing * kernel.gradient(math::sqrt(r2));
    }
    KOKKOS_INLINE_FUNCTION Wall look(int i) const {
        Wall wall;
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double w = weight(s, r2);
            wall.area[0] += w * dx;
            wall.area[1] += w * dy;
            wall.area[2] += w * dz;
            for (int k = 0; k < 3; ++k) wall.velocity[k] += w * fluid.solid_velocity(s, k);
            wall.coefficient += w * coefficient(fluid.solid_body(s));
            wall.weights += w;
        });
        const double* a = wall.area;
        wall.size = math::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
        if (!(wall.size > 0 && wall.coefficient > 0)) return {};
        for (double& v : wall.velocity) v /= wall.weights;
        wall.coefficient /= wall.weights;
        return wall;
    }

    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        if (fluid.solid.count(i) == 0) return;
        const Wall wall = look(i);
        if (wall.size == 0) return;
        double along[3], out = 0; // velocity relative to the wall, and its part normal to it
        for (int k = 0; k < 3; ++k) {
            along[k] = fluid.velocity(i, k) - wall.velocity[k];
            out += along[k] * wall.area[k] / wall.size;
        }
        double speed2 = 0;
        for (int k = 0; k < 3; ++k) {
            along[k] -= out * wall.area[k] / wall.size;
            speed2 += along[k] * along[k];
        }
        const double rate = 0.5 * dt * wall.coefficient * math::sqrt(speed2) * wall.size;
        double force[3]; // on the walls [N]
        for (int k = 0; k < 3; ++k) {
            const double lost = along[k] * (rate / (1 + rate));
            fluid.velocity(i, k) -= lost;
            force[k] = fluid.constants.mass * relative(i) * lost / dt;
        }
        const auto& x = fluid.solid.among;
        const double total_weight = wall.coefficient * wall.weights;
        fluid.solid.each(i, [&](int s, double, double, double, double r2) {
            const double fraction = weight(s, r2) * coefficient(fluid.solid_body(s)) / total_weight;
            const double position[3] = {x(s, 0), x(s, 1), x(s, 2)};
            const double part[3] = {fraction * force[0], fraction * force[1], fraction * force[2]};
            points.add(sum + 6 * fluid.solid_body(s), fluid.solid_body(s), position, part);
        });
    }
};
} // namespace

void apply_skin_friction(const StepContext& parts, const SkinFriction& friction, BodyLoads& loads) {
    const auto& coefficients = friction.coefficients;
    if (std::ranges::all_of(coefficients, [](double c) { return c == 0; })) return;
    const auto& constants = parts.constants;
    const auto fluid = make_views(constants, parts.liquid, parts.solid, parts.neighbours);
    const auto coefficient = upload(coefficients);
    BodyLoads own(loads.size(), 0.0);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const SkinFrictionLoop<Kernel> loop{{own.size()}, kernel, fluid, friction.points,
            relative_density(constants, parts.liquid), coefficient, friction.dt};
        Kokkos::parallel_reduce("treacle::skin_friction", fluid.count, loop, host_sums(own));
    });
    for (std::size_t k = 0; k < loads.size(); ++k) loads[k] += own[k];
}

} // namespace treacle::sph
