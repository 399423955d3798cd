#include "change.hpp"
#include "sph/solids/slip_lattice.hpp"
#include "sph/viscosity/implicit_viscosity.hpp"

namespace treacle::sph::viscous_walls_test {
namespace {

constexpr double viscosity = 50; // [Pa s]

// Parts of a step with the implicit viscosity and the bodies of the sample.
struct ViscousCase {
    Parts parts;
    Bodies bodies;
    ImplicitViscosity solver;

    ViscousCase(const Comm& comm, const Sample& sample)
        : parts(comm, sample),
          bodies(sample.setup.rigid, {}, sample.setup.first_body, sample.setup.bodies, sample.setup.domain),
          solver(parts.comm, parts.liquid, sample.setup.options.viscosity, sample.setup.grid,
              sample.setup.forces.friction, sample.setup.forces.slip_length, sample.setup.forces.rheology) {
        parts.solid_halo.gather(parts.solid.store, {parts.solid.normal_field()});
    }
    // The loads of all ranks.
    ImplicitViscosity::Result solve(double dt) {
        auto result = solver.solve({{parts.setup.options, parts.setup.constants, parts.comm, parts.liquid, parts.solid,
                                        parts.neighbours, parts.halo, parts.liquid_cells},
                                       parts.setup.forces, &parts.solid_halo},
            bodies, dt);
        EXPECT_TRUE(result.solve.converged()) << result.solve.reason;
        parts.comm.sum(std::span(result.loads));
        return result;
    }
};

// nu dt / d^2 of a step.
double step_of(double number) { return number * spacing * spacing * rest_density / viscosity; }

void measure_walls(Sample& sample) {
    auto& c = sample.setup.constants;
    const auto& options = sample.setup.options;
    const WallSetup wall{options.kernel, c.dimensions, c.support, c.spacing, c.spacing};
    c.wall_depth = equilibrium_wall_distance(wall, options.density) - 0.5 * spacing;
    const double viscous = viscous_support(options, c.spacing);
    c.wall_viscous_factor = wall_viscous_factor(wall, options.density, viscous);
    measure_slip(wall, options.density, viscous, c);
}

// A plane channel between the solids 0 below, at rest, and 1 above.
constexpr int layers = 16;
Sample channel(int dimensions, double slip) {
    SphOptions options;
    options.viscosity.residual = 1e-10;
    options.viscosity.preconditioner = ViscosityPreconditioner::jacobi; // it is small
    const bool space = dimensions == 3;
    const int across = 8;
    const Vec3 far{across * spacing, (layers + 4) * spacing, across * spacing};
    Sample sample{make_setup(make_domain(dimensions, {0, -4 * spacing, 0}, far,
                                 {scene::BoundaryKind::open, {true, false, space}}),
                      options),
        {}, {}};
    measure_walls(sample);
    sample.setup.forces.viscosity = viscosity;
    add_block(sample, {{spacing / 2, spacing / 2, space ? spacing / 2 : 0}, {across, layers, space ? across : 1}});
    const double depth = sample.setup.constants.wall_depth;
    for (int k = 0; k < (space ? across : 1); ++k) {
        for (int i = 0; i < across; ++i) {
            const double x = (i + 0.5) * spacing, z = space ? (k + 0.5) * spacing : 0;
            sample.solid.push_back({{x, -depth, z}, 0, {0, 1, 0}});
            sample.solid.push_back({{x, layers * spacing + depth, z}, 1, {0, -1, 0}});
        }
    }
    rigid::BodySetup plate;
    plate.kind = scene::BodyKind::kinematic;
    plate.velocity = {1, 0, 0};
    sample.setup.rigid.bodies = {plate};
    sample.setup.rigid.dimensions = dimensions;
    sample.setup.first_body = 1;
    const double friction = slip > 0 ? 0 : 1;
    sample.setup.forces.friction = {friction, friction};
    sample.setup.forces.slip_length = {slip, slip};
    return sample;
}
} // namespace

TEST(WallSlip, CouetteFlowIsExactForAnySlipLength) {
    for (const int dimensions : {2, 3}) {
        for (const double b : {0.0, 0.5, 1.0, 2.0, 5.0, 50.0}) {
            ViscousCase one(Comm::world(), channel(dimensions, b * spacing));
            const auto result = one.solve(step_of(1e7));
            const double height = (layers + 2 * b) * spacing;
            double near = 0, far = 0; // velocities off, over what they change in a spacing
            for (const auto& [id, now] : all_states(one.parts.comm, one.parts.liquid)) {
                const double off = std::abs(now.u[0] * height - now.x[1] - b * spacing) / spacing;
                const bool beside = now.x[1] < 4 * spacing || now.x[1] > (layers - 4) * spacing;
                (beside ? near : far) = std::max(beside ? near : far, off);
            }
            // Of rows without slip seen 0.02 and 0.13, with slip 0.04 and 0.06.
            EXPECT_LT(far, 0.05) << b << " in " << dimensions;
            EXPECT_LT(near, b == 0 ? 0.15 : 0.08) << b << " in " << dimensions;
            const double area = dimensions == 3 ? 64 * spacing * spacing : 8 * spacing;
            EXPECT_NEAR(result.loads[0], viscosity * area / height, 0.01 * viscosity * area / height) << b;
            EXPECT_NEAR(result.loads[0], -result.loads[6], 1e-4 * result.loads[0]) << "the liquid itself takes nothing";
        }
    }
}

TEST(ViscousWalls, CouetteFlowStartsUpAsItShould) {
    ViscousCase one(Comm::world(), channel(2, 0));
    const double height = layers * spacing, dt = step_of(0.5), nu = viscosity / rest_density;
    double time = 0, worst = 0;
    for (const double end : {0.05, 0.2, 1.0}) { // nu t / H^2
        for (; nu * time < (end - 1e-9) * height * height; time += dt) one.solve(dt);
        for (const auto& [id, now] : all_states(one.parts.comm, one.parts.liquid)) {
            double exact = now.x[1] / height; // and the series of what a plate that starts at once leaves
            for (int n = 1; n < 100; ++n) {
                const double wave = n * math::pi;
                exact += 2 / wave * (n % 2 == 0 ? 1 : -1) * std::exp(-wave * wave * nu * time / (height * height)) *
                         std::sin(wave * now.x[1] / height);
            }
            worst = std::max(worst, std::abs(now.u[0] - exact));
        }
    }
    RecordProperty("couette_error", std::to_string(worst));
    EXPECT_LT(worst, 0.02);
}

namespace {
enum class Surface { no_slip, slips };
// A disc of 5 spacings radius inside of a disc of liquid of 12, in free space.
Sample disc_in_liquid(Surface surface, double density_ratio) {
    SphOptions options;
    options.viscosity.residual = 1e-13;
    const double size = 32 * spacing, middle = size / 2, radius = 5 * spacing;
    Sample sample{
        make_setup(make_domain(2, {0, 0, 0}, {size, size, spacing}, {scene::BoundaryKind::open}), options), {}, {}};
    measure_walls(sample);
    sample.setup.forces.viscosity = viscosity;
    Sample block{sample.setup, {}, {}};
    add_block(block, {{spacing / 2, spacing / 2, 0}, {32, 32, 1}, spacing, 0.1});
    test::Random random(5);
    for (auto point : block.liquid) {
        const double r = std::hypot(point.x[0] - middle, point.x[1] - middle);
        if (r < radius + 0.4 * spacing || r > 12 * spacing) continue;
        point.u = {2 * random.unit() - 1, 2 * random.unit() - 1, 0};
        sample.liquid.push_back(point);
    }
    const double depth = sample.setup.constants.wall_depth;
    const int around = 28;
    for (int k = 0; k < around; ++k) {
        const double a = 2 * math::pi * k / around;
        const Vec3 n{std::cos(a), std::sin(a), 0};
        sample.solid.push_back({{middle + (radius - depth) * n[0], middle + (radius - depth) * n[1], 0}, 1, n});
    }
    rigid::BodySetup disc;
    disc.kind = scene::BodyKind::dynamic;
    disc.mass = density_ratio * rest_density * math::pi * radius * radius;
    disc.inertia[2][2] = disc.inertia[0][0] = disc.inertia[1][1] = disc.mass * radius * radius / 2;
    disc.centre = {middle, middle, 0};
    disc.velocity = {1, -0.5, 0};
    disc.angular_velocity = {0, 0, 3};
    disc.locked = {false, false, true, true, true, false};
    sample.setup.rigid.bodies = {disc};
    sample.setup.rigid.dimensions = 2;
    sample.setup.rigid.spacing = spacing;
    sample.setup.first_body = 1;
    const bool slips = surface == Surface::slips;
    sample.setup.forces.friction = {0, slips ? 0.0 : 1.0};
    sample.setup.forces.slip_length = {0, slips ? 0.5 * spacing : 0};
    return sample;
}

double kinetic_energy(const ViscousCase& one) {
    double sum = one.bodies.rigid.energy()[0];
    for (const auto& [id, now] : all_states(one.parts.comm, one.parts.liquid)) {
        sum += 0.5 * one.parts.setup.constants.mass * (now.u[0] * now.u[0] + now.u[1] * now.u[1]);
    }
    return sum;
}
} // namespace

TEST(ViscousBodies, KeepTheMomentumOfLiquidAndBodyTogether) {
    for (const auto surface : {Surface::no_slip, Surface::slips}) {
        for (const double ratio : {0.1, 10.0}) {
            ViscousCase one(Comm::world(), disc_in_liquid(surface, ratio));
            const auto before = all_states(one.parts.comm, one.parts.liquid);
            const auto own = one.bodies.rigid.momentum();
            const double dt = step_of(1);
            const auto result = one.solve(dt);
            one.bodies.rigid.push(one.bodies.loads_of(result.loads), dt);
            const auto now = one.bodies.rigid.momentum();
            const auto sum = change(one.parts, before);
            // Round-off and the residual of 1e-13, over what moved.
            for (std::size_t k = 0; k < 3; ++k) {
                EXPECT_NEAR(sum.momentum[k] + now[k] - own[k], 0, 1e-12 * sum.size) << k << " at " << ratio;
                EXPECT_NEAR(sum.angular[k] + now[3 + k] - own[3 + k], 0, 1e-12 * sum.size) << k << " at " << ratio;
            }
        }
    }
}

TEST(ViscousBodies, MoveAsOneWithAStiffLiquidHoweverLight) {
    for (const auto surface : {Surface::no_slip, Surface::slips}) {
        for (const double ratio : {0.001, 0.1, 10.0}) {
            const auto sample = disc_in_liquid(surface, ratio);
            ViscousCase one(Comm::world(), sample);
            const double energy = kinetic_energy(one), dt = step_of(1e4);
            const auto result = one.solve(dt);
            one.bodies.rigid.push(one.bodies.loads_of(result.loads), dt);
            EXPECT_LT(kinetic_energy(one), energy);
            const double middle = sample.setup.rigid.bodies[0].centre[0], spin = one.bodies.rigid.spin(0)[2];
            double slide = 0;
            for (const auto& [id, state] : all_states(one.parts.comm, one.parts.liquid)) {
                slide = std::max(
                    slide, std::abs(state.u[0] - one.bodies.rigid.velocity(0)[0] + spin * (state.x[1] - middle)));
            }
            EXPECT_LT(slide, 0.0144) << "R^2 / nu dt of velocities of 1 m/s";
        }
    }
}

TEST(ViscousBodies, ThatAreHeldFeelTheForceAndStay) {
    auto sample = disc_in_liquid(Surface::no_slip, 0.1);
    sample.setup.rigid.bodies[0].locked[0] = true;
    sample.setup.rigid.bodies[0].velocity = {0, 0, 0};
    ViscousCase one(Comm::world(), sample);
    const double dt = step_of(1);
    const auto result = one.solve(dt);
    one.bodies.rigid.push(one.bodies.loads_of(result.loads), dt);
    EXPECT_EQ(one.bodies.rigid.velocity(0)[0], 0);
    EXPECT_NE(one.bodies.rigid.velocity(0)[1], 0);
    EXPECT_NE(result.loads[6], 0);
}

TEST(ViscousBodies, LightOnesAreShakenWhenTheyFeelTheForceAfterwards) {
    auto sample = disc_in_liquid(Surface::no_slip, 0.1);
    sample.setup.options.viscosity.coupling = BodyCoupling::weak;
    ViscousCase one(Comm::world(), sample);
    const double energy = kinetic_energy(one), dt = step_of(1e4);
    const auto result = one.solve(dt);
    one.bodies.rigid.push(one.bodies.loads_of(result.loads), dt);
    EXPECT_GT(kinetic_energy(one), 10 * energy);
}

TEST(ViscousBodies, TurnWithTheLiquidForEver) {
    for (const auto surface : {Surface::no_slip, Surface::slips}) {
        auto sample = disc_in_liquid(surface, 0.1);
        auto& disc = sample.setup.rigid.bodies[0];
        disc.velocity = {0, 0, 0};
        disc.angular_velocity = {0, 0, 1};
        for (auto& point : sample.liquid) point.u = {disc.centre[1] - point.x[1], point.x[0] - disc.centre[0], 0};
        ViscousCase one(Comm::world(), sample);
        const auto before = all_states(one.parts.comm, one.parts.liquid);
        const double dt = step_of(1e4);
        const auto result = one.solve(dt);
        one.bodies.rigid.push(one.bodies.loads_of(result.loads), dt);
        for (const auto& [id, now] : all_states(one.parts.comm, one.parts.liquid)) {
            for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(now.u[k], before.at(id).u[k], 1e-10);
        }
        EXPECT_NEAR(one.bodies.rigid.spin(0)[2], 1, 1e-10);
    }
}

TEST(ViscousBodies, MoveTheSameOnAnyNumberOfRanks) {
    for (const auto surface : {Surface::no_slip, Surface::slips}) {
        const auto velocity_on = [&](const Comm& comm) {
            ViscousCase one(comm, disc_in_liquid(surface, 0.1));
            const double dt = step_of(10);
            const auto result = one.solve(dt);
            one.bodies.rigid.push(one.bodies.loads_of(result.loads), dt);
            return std::array<double, 3>{
                one.bodies.rigid.velocity(0)[0], one.bodies.rigid.velocity(0)[1], one.bodies.rigid.spin(0)[2]};
        };
        const auto many = velocity_on(Comm::world()), one = velocity_on(Comm::self());
        // The solver's tolerance, times the condition of a light body.
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(many[k], one[k], 1e-9);
    }
}

} // namespace treacle::sph::viscous_walls_test
