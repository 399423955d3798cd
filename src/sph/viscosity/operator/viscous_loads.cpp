#include "sph/viscosity/operator/viscous_loops.hpp"

#include <algorithm>

namespace treacle::sph {

namespace {
// The reaction of the no-slip stresses, per solid.
template <class Kernel, class WallForce>
struct ViscousLoadLoop : ViscousLoop<Kernel>, LoadReduction {
    using Base = ViscousLoop<Kernel>;
    WallForce wall_force;
    double scale; // m / dt

    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        double u[3];
        Base::read_velocity(i, u);
        Base::each_wall(i, [&](int s, double w, double dx, double dy, double dz, const auto& contact) {
            const double x[3] = {dx, dy, dz};
            double force[3];
            wall_force(i, w, x, u, contact, force);
            for (double& f : force) f *= scale;
            const int body = Base::walls.body(s);
            Base::walls.points.add(sum + 6 * body, body, contact.position, force);
        });
    }
};

// Stiffness of the no-slip stresses against the motion of each solid, to precondition.
template <class Kernel>
struct StiffnessLoop : ViscousLoop<Kernel>, LoadReduction {
    using Base = ViscousLoop<Kernel>;
    Array<double> viscous_coefficient;

    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        Base::each_wall(i, [&](int s, double w, double, double, double, const auto& contact) {
            Base::walls.points.add_stiffness(
                sum, Base::walls.body(s), contact.position, 2 * viscous_coefficient(i) * w * contact.beta);
        });
    }
};

bool any_no_slip(const ViscousContext& parts) {
    const auto& friction = parts.forces.friction;
    return parts.neighbours.solid.size > 0 && std::ranges::any_of(friction, [](double f) { return f > 0; });
}
} // namespace

BodyLoads ViscousOperator::loads(const ViscousContext& parts) const {
    const auto& constants = parts.constants;
    BodyLoads out(static_cast<std::size_t>(6 * parts.points.count), 0.0);
    const auto fluid = make_views(constants, parts.liquid, parts.solid, parts.neighbours);
    const double scale = constants.mass / dt_;
    if (slip_.any()) slip_.add_loads(parts, parts.motion, scale, out);
    if (!any_no_slip(parts)) return out;
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, Walls::moving), weights_, wall_sums_};
        const auto sum = [&](const auto& wall_force) {
            using WallForce = std::decay_t<decltype(wall_force)>;
            BodyLoads sums(out.size(), 0.0);
            Kokkos::parallel_reduce("treacle::viscous_loads", fluid.count,
                ViscousLoadLoop<Kernel, WallForce>{base, {sums.size()}, wall_force, scale}, host_sums(sums));
            for (std::size_t k = 0; k < out.size(); ++k) out[k] += sums[k];
        };
        if (by_gradients(parts.options.viscosity.form)) {
            const auto& store = parts.liquid.store;
            sum(WallStressForce<Stresses>{
                {{store.get<Array3>(stress_[0]), store.get<Array3>(stress_[1]), store.get<Array3>(stress_[2])}},
                store.get<Array<double>>(viscous_coefficient_), damping_});
        } else {
            sum(wall_pair_force(parts, parts.liquid.store.get<Array<double>>(viscous_coefficient_)));
        }
    });
    return out;
}

std::vector<double> ViscousOperator::stiffness(const ViscousContext& parts) const {
    const auto& constants = parts.constants;
    std::vector<double> out(static_cast<std::size_t>(36 * parts.points.count), 0.0);
    const auto viscous_coefficient = parts.liquid.store.get<Array<double>>(viscous_coefficient_);
    const auto fluid = make_views(constants, parts.liquid, parts.solid, parts.neighbours);
    if (any_no_slip(parts)) {
        with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
            using Kernel = std::decay_t<decltype(kernel)>;
            const ViscousLoop<Kernel> base{kernel, fluid, walls(parts, Walls::resting), weights_, wall_sums_};
            Kokkos::parallel_reduce("treacle::viscous_stiffness", fluid.count,
                StiffnessLoop<Kernel>{base, {out.size()}, viscous_coefficient}, host_sums(out));
        });
    }
    if (slip_.any()) slip_.add_stiffness(parts, out);
    return out;
}

} // namespace treacle::sph
