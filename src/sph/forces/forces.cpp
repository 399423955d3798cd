#include "sph/forces/forces.hpp"

#include <algorithm>

namespace treacle::sph {

namespace {
template <class Kernel, class Liquids>
struct ForceLoop {
    Kernel kernel;
    Liquids liquids;
    Fluid fluid;
    double gravity[3];
    double artificial, viscosity;
    Array<double> friction;
    Array3 acceleration;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Constants& c = fluid.constants;
        const auto& u = fluid.velocity;
        double ax = gravity[0], ay = gravity[1], az = gravity[2];
        SimdDouble fx = 0.0, fy = 0.0, fz = 0.0;
        const double soft = 0.01 * c.support * c.support;
        // Densities of pairs are the rest density here: the liquid is incompressible, and a division less counts.
        const double pair_viscosity =
            2 * (Kernel::dimensions + 2) * liquids.scale() / (c.rest_density * c.rest_density);
        const double pair_artificial_viscosity = artificial / c.rest_density;
        const double ux = u(i, 0), uy = u(i, 1), uz = u(i, 2);
        if (artificial > 0 || viscosity > 0) {
            const Row row = fluid.row(i);
            const auto partners = liquids.partners(i);
            for (int k = 0; k < row.count; k += lanes) {
                const auto d = row.near(k);
                const auto v = fluid.motions(row, k);
                const auto along = distance(d.r2);
                const SimdDouble approach = (ux - v.x) * d.x + (uy - v.y) * d.y + (uz - v.z) * d.z;
                const SimdDouble drag =
                    partners.drag(row.index + k, pair_viscosity, pair_artificial_viscosity, approach);
                const SimdDouble f =
                    row.within(k, c.mass * drag * inverse(d.r2 + soft) * kernel.gradient(along.r, along.inverse));
                fx = fx + f * d.x;
                fy = fy + f * d.y;
                fz = fz + f * d.z;
            }
            ax += sum_lanes(fx);
            ay += sum_lanes(fy);
            az += sum_lanes(fz);
        }
        const double own = 2 * (Kernel::dimensions + 2) * liquids.viscosity(i) / (c.rest_density * c.rest_density) /
                           liquids.density(i);
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double friction_factor = friction(fluid.solid_body(s));
            if (friction_factor == 0) return;
            const auto& v = fluid.solid_velocity;
            const double approach = (ux - v(s, 0)) * dx + (uy - v(s, 1)) * dy + (uz - v(s, 2)) * dz;
            const double drag = own * approach + pair_artificial_viscosity * math::min(approach, 0.0);
            const double mass = c.rest_density * fluid.solid_volume(s) / c.wall_packing * friction_factor;
            const double f = mass * drag / (r2 + soft) * kernel.gradient(math::sqrt(r2));
            ax += f * dx;
            ay += f * dy;
            az += f * dz;
        });
        acceleration(i, 0) = ax;
        acceleration(i, 1) = ay;
        acceleration(i, 2) = Kernel::dimensions == 3 ? az : 0;
    }
};

template <class Kernel, class Liquids>
struct PressureForceLoop {
    Kernel kernel;
    Liquids liquids;
    Fluid fluid;
    Array3 velocity;
    double dt;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const Constants& c = fluid.constants;
        const double own = fluid.load(i);
        const Row row = fluid.row(i);
        const auto partners = liquids.partners(i);
        SimdDouble fx = 0.0, fy = 0.0, fz = 0.0;
        for (int k = 0; k < row.count; k += lanes) {
            const auto d = row.near(k);
            const auto along = distance(d.r2);
            const SimdDouble f = row.within(
                k, -c.mass * partners.loads(row.index + k, own, d.number) * kernel.gradient(along.r, along.inverse));
            fx = fx + f * d.x;
            fy = fy + f * d.y;
            fz = fz + f * d.z;
        }
        double ax = sum_lanes(fx), ay = sum_lanes(fy), az = sum_lanes(fz);
        if (own > 0) {
            const double load = fluid.constants.wall_pressure_factor * own / liquids.density(i);
            fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
                const double f = -c.rest_density * fluid.solid_volume(s) * load * kernel.gradient(math::sqrt(r2));
                ax += f * dx;
                ay += f * dy;
                az += f * dz;
            });
        }
        velocity(i, 0) += dt * ax;
        velocity(i, 1) += dt * ay;
        velocity(i, 2) += dt * az;
    }
};

// Sums the reaction of the pressure force over the pairs, per body.
template <class Kernel>
struct BodyLoadLoop : LoadReduction {
    Kernel kernel;
    Fluid fluid;
    MomentReferencePoints points;

    KOKKOS_INLINE_FUNCTION void add(value_type sum, int s, const double force[3]) const {
        const auto& x = fluid.solid.among;
        const double position[3] = {x(s, 0), x(s, 1), x(s, 2)};
        points.add(sum + 6 * fluid.solid_body(s), fluid.solid_body(s), position, force);
    }
    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        const Constants& c = fluid.constants;
        const double own = c.wall_pressure_factor * fluid.load(i);
        if (!(own > 0)) return;
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double f = c.mass * c.rest_density * fluid.solid_volume(s) * own *
                             kernel.gradient(math::sqrt(r2)); // on the solid, along x_i - x_s
            const double along[3] = {f * dx, f * dy, f * dz};
            double force[3];
            fluid.correction.towards_solid(i, s, along, force);
            add(sum, s, force);
        });
    }
};

// The reaction of the viscous forces of ForceLoop, pair by pair.
template <class Kernel, class Liquids>
struct ViscousLoadLoop : BodyLoadLoop<Kernel> {
    using Base = BodyLoadLoop<Kernel>;
    using value_type = double[];
    using size_type = std::size_t;
    Liquids liquids;
    double artificial;
    Array<double> friction;

    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type sum) const {
        const Fluid& fluid = Base::fluid;
        const Constants& c = fluid.constants;
        const auto &u = fluid.velocity, &v = fluid.solid_velocity;
        const double soft = 0.01 * c.support * c.support;
        const double pair_viscosity =
            2 * (Kernel::dimensions + 2) * liquids.viscosity(i) / (c.rest_density * c.rest_density);
        const double pair_artificial_viscosity = artificial / c.rest_density * liquids.density(i);
        fluid.solid.each(i, [&](int s, double dx, double dy, double dz, double r2) {
            const double friction_factor = friction(fluid.solid_body(s));
            if (friction_factor == 0) return;
            const double approach = (u(i, 0) - v(s, 0)) * dx + (u(i, 1) - v(s, 1)) * dy + (u(i, 2) - v(s, 2)) * dz;
            const double drag = pair_viscosity * approach + pair_artificial_viscosity * math::min(approach, 0.0);
            const double mass = c.rest_density * fluid.solid_volume(s) / c.wall_packing * friction_factor;
            const double f = -c.mass * mass * drag / (r2 + soft) * Base::kernel.gradient(math::sqrt(r2));
            const double force[3] = {f * dx, f * dy, Kernel::dimensions == 3 ? f * dz : 0};
            Base::add(sum, s, force);
        });
    }
};

template <class Kernel, class Liquids>
struct XsphLoop {
    Kernel kernel;
    Liquids liquids;
    Fluid fluid;
    double weight;
    Array3 correction;

    KOKKOS_INLINE_FUNCTION void operator()(int i) const {
        const auto& u = fluid.velocity;
        double cx = 0, cy = 0, cz = 0;
        fluid.liquid.each(i, [&](int j, double, double, double, double r2) {
            const double w = 0.5 * (fluid.volume(i) + fluid.volume(j)) * kernel.value(math::sqrt(r2)) *
                             liquids.pair_artificial_viscosity(i, j);
            cx += w * (u(j, 0) - u(i, 0));
            cy += w * (u(j, 1) - u(i, 1));
            cz += w * (u(j, 2) - u(i, 2));
        });
        correction(i, 0) = weight * cx;
        correction(i, 1) = weight * cy;
        correction(i, 2) = weight * cz;
    }
};

// u += dt a
void accelerate(const LiquidParticles& liquid, double dt) {
    const auto u = liquid.velocity(), a = liquid.acceleration();
    Kokkos::parallel_for(
        "treacle::accelerate", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            for (int k = 0; k < 3; ++k) u(i, k) += dt * a(i, k);
        });
}
} // namespace

BodyLoads apply_forces(
    const StepContext& parts, const ForceOptions& forces, double dt, const MomentReferencePoints& points) {
    const auto& options = parts.options;
    const auto& constants = parts.constants;
    auto& liquid = parts.liquid;
    pack_positions(liquid, liquid.volume());
    pack_velocities(liquid);
    const auto fluid = make_views(constants, liquid, parts.solid, parts.neighbours);
    const auto& g = forces.gravity;
    const auto friction = upload(forces.friction);
    BodyLoads loads(static_cast<std::size_t>(6 * points.count), 0.0);
    bool no_slip =
        (forces.artificial > 0 || forces.viscosity > 0) && parts.neighbours.solid.size > 0 && points.count > 0;
    no_slip = no_slip && std::any_of(forces.friction.begin(), forces.friction.end(), [](double f) { return f > 0; });
    with_kernel(options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        with_liquids(constants.immiscible, liquid.liquid(), forces.viscosity, [&](const auto& liquids) {
            using Liquids = std::decay_t<decltype(liquids)>;
            Kokkos::parallel_for("treacle::forces", fluid.count,
                ForceLoop<Kernel, Liquids>{kernel, liquids, fluid, {g[0], g[1], g[2]}, forces.artificial,
                    forces.viscosity, friction, liquid.acceleration()});
            if (!no_slip) return;
            Kokkos::parallel_reduce("treacle::viscous_loads", fluid.count,
                ViscousLoadLoop<Kernel, Liquids>{
                    {{loads.size()}, kernel, fluid, points}, liquids, forces.artificial, friction},
                host_sums(loads));
        });
    });
    accelerate(liquid, dt);
    return loads;
}

double viscous_step_limit(const Constants& constants, double viscosity) {
    if (viscosity <= 0) return 1e300;
    return 0.125 * constants.support * constants.support * constants.rest_density / viscosity;
}

double viscous_step_limit(const ViscosityOptions& options, const Constants& constants, double viscosity) {
    if (options.integration == ViscosityIntegration::implicit) return 1e300;
    const bool by_pairs = options.integration == ViscosityIntegration::explicit_pairs ||
                          options.form == ViscosityForm::pairwise || options.form == ViscosityForm::laplacian;
    return (by_pairs ? 1 : 0.1) * viscous_step_limit(constants, viscosity);
}

void compute_pressure_over_density2(const Constants& constants, LiquidParticles& liquid) {
    const auto load = liquid.load(), p = liquid.pressure(), volume = liquid.volume();
    const double inverse_mass = 1 / constants.mass;
    Kokkos::parallel_for(
        "treacle::loads", liquid.store.owned(), KOKKOS_LAMBDA(int i) {
            const double specific = volume(i) * inverse_mass;
            load(i) = p(i) * specific * specific;
        });
}

BodyLoads apply_pressure(const StepContext& parts, const MomentReferencePoints& points, double dt) {
    const auto& constants = parts.constants;
    auto& liquid = parts.liquid;
    pack_positions(liquid, liquid.load());
    const auto fluid = make_views(constants, liquid, parts.solid, parts.neighbours);
    BodyLoads loads(static_cast<std::size_t>(6 * points.count), 0.0);
    with_kernel(parts.options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        if (fluid.correction.exists()) {
            accelerate(liquid, dt);
        } else {
            with_liquids(constants.immiscible, liquid.liquid(), 0, [&](const auto& liquids) {
                using Liquids = std::decay_t<decltype(liquids)>;
                Kokkos::parallel_for("treacle::pressure_force", fluid.count,
                    PressureForceLoop<Kernel, Liquids>{kernel, liquids, fluid, liquid.velocity(), dt});
            });
        }
        if (parts.neighbours.solid.size > 0) {
            Kokkos::parallel_reduce("treacle::body_loads", fluid.count,
                BodyLoadLoop<Kernel>{{loads.size()}, kernel, fluid, points}, host_sums(loads));
        }
    });
    return loads;
}

void compute_xsph(const SphOptions& options, const Constants& constants, LiquidParticles& liquid,
    const SolidParticles& solid, const Neighbourhood& neighbours) {
    const auto fluid = make_views(constants, liquid, solid, neighbours);
    with_kernel(options.kernel, constants.dimensions, constants.support, [&](const auto& kernel) {
        using Kernel = std::decay_t<decltype(kernel)>;
        with_liquids(constants.immiscible, liquid.liquid(), 0, [&](const auto& liquids) {
            using Liquids = std::decay_t<decltype(liquids)>;
            Kokkos::parallel_for("treacle::xsph", fluid.count,
                XsphLoop<Kernel, Liquids>{kernel, liquids, fluid, options.viscosity.xsph, liquid.acceleration()});
        });
    });
}

} // namespace treacle::sph
