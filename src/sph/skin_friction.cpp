#include "sph/skin_friction.hpp"

#include <algorithm>

namespace treacle::sph {

namespace {
template <class Kernel>
struct SkinFrictionLoop {
    Kernel kernel;
    Fluid fluid;
    Array<double> coefficient;
    double dt;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        if (fluid.solid.count(i) == 0) return;
        double area[3] = {0, 0, 0}, wall[3] = {0, 0, 0}, weights = 0, friction = 0;
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double vg = -fluid.solid_volume(s) * kernel.gradient(math::sqrt(r2));
            area[0] += vg * dx;
            area[1] += vg * dy;
            area[2] += vg * dz;
            for (int k = 0; k < 3; ++k) wall[k] += vg * fluid.solid_velocity(s, k);
            friction += vg * coefficient(fluid.solid_body(s));
            weights += vg;
        });
        const double size = math::sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
        if (!(size > 0 && friction > 0)) return;
        double along[3], out = 0; // velocity relative to the wall, and its part normal to it
        for (int k = 0; k < 3; ++k) {
            along[k] = fluid.velocity(i, k) - wall[k] / weights;
            out += along[k] * area[k] / size;
        }
        double speed2 = 0;
        for (int k = 0; k < 3; ++k) {
            along[k] -= out * area[k] / size;
            speed2 += along[k] * along[k];
        }
        const double rate = 0.5 * dt * friction / weights * math::sqrt(speed2) * size;
        for (int k = 0; k < 3; ++k) fluid.velocity(i, k) -= along[k] * (rate / (1 + rate));
    }
};
} // namespace

void apply_skin_friction(const SphOptions& options, const Constants& constants, LiquidParticles& liquid,
                         const SolidParticles& solid, const Neighbourhood& neighbours,
                         const std::vector<double>& coefficients, double dt) {
    if (std::ranges::all_of(coefficients, [](double c) { return c == 0; })) return;
    const auto fluid = gather_fluid(constants, liquid, solid, neighbours);
    const Array<double> coefficient("treacle::skin_friction", coefficients.size());
    const auto host = Kokkos::create_mirror_view(coefficient);
    for (std::size_t k = 0; k < coefficients.size(); ++k) host(k) = coefficients[k];
    Kokkos::deep_copy(coefficient, host);
    with_kernel(options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        Kokkos::parallel_for("treacle::skin_friction", fluid.count,
                             SkinFrictionLoop<Kernel>{kernel, fluid, coefficient, dt});
    });
}

} // namespace treacle::sph
