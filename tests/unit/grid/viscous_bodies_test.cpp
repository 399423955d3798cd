#include "viscous_sample.hpp"

namespace treacle::grid::viscous_bodies_test {
namespace {

rigid::BodiesSetup world(std::vector<rigid::BodySetup> bodies, int dimensions = 3) {
    rigid::BodiesSetup out;
    out.bodies = std::move(bodies);
    out.dimensions = dimensions;
    return out;
}

class GridViscousBodies : public ::testing::Test {
protected:
    const Comm comm = Comm::world();

    // A ball of liquid that a smaller one, off its middle, partly sticks out of; and one that is inside.
    ViscousSample two_bodies(double viscosity) const {
        ViscousSample sample;
        sample.cells = 20;
        sample.liquid = ball({0.5, 0.5, 0.5}, 0.32);
        sample.body = {ball({0.7, 0.55, 0.5}, 0.13), ball({0.4, 0.45, 0.47}, 0.11)};
        auto first = make_body({0.7, 0.55, 0.5}, 30, 0.13), second = make_body({0.4, 0.45, 0.47}, 4, 0.11);
        first.velocity = {1, 0, 0.5};
        second.angular_velocity = {0, 3, -2};
        sample.bodies = world({first, second});
        sample.viscosity = [=](const Vec3&) { return viscosity; };
        sample.options.residual = 1e-13;
        return sample;
    }
};

TEST_F(GridViscousBodies, momentum_of_liquid_and_bodies_is_kept) {
    for (const auto& [viscosity, slips] : {std::pair{10.0, false}, {1e5, false}, {1e3, true}}) {
        auto sample = two_bodies(viscosity);
        sample.solid_slips = slips;
        sample.slip_length = 0.1;
        ViscousCase run(comm, sample);
        run.set_noise();
        const auto total = [&] {
            auto sum = run.liquid_momentum();
            const auto bodies = run.bodies.momentum();
            for (std::size_t k = 0; k < 6; ++k) sum[k] += bodies[k];
            return sum;
        };
        const auto before = total();
        const auto report = run.solve(0.01);
        const auto after = total();
        const double size = 1000 * 4.2 * std::pow(0.32, 3);
        for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(after[k], before[k], 1e-10 * size) << k;
        EXPECT_LT(report.solve.iterations, 80);
    }
}

// Bodies whose motion is prescribed, as those of a rheometer.
TEST_F(GridViscousBodies, driven_bodies_are_loaded_with_what_the_liquid_gains) {
    for (const bool slips : {false, true}) {
        auto sample = two_bodies(1e3);
        sample.solid_slips = slips;
        sample.slip_length = 0.1;
        for (auto& body : sample.bodies.bodies) body.kind = scene::BodyKind::kinematic;
        ViscousCase run(comm, sample);
        run.set_velocity([](int, const Vec3&) { return 0.0; });
        const double dt = 0.01;
        const auto loads = run.solve(dt).loads;
        const auto gained = run.liquid_momentum();
        std::array<double, 6> lost{};
        for (std::size_t b = 0; b < run.bodies.size(); ++b) {
            const auto& r = sample.bodies.bodies[b].centre;
            const double* const f = &loads[6 * b];
            const Vec3 turning = rigid::cross(r, {f[0], f[1], f[2]});
            for (std::size_t k = 0; k < 3; ++k) {
                lost[k] += dt * f[k];
                lost[3 + k] += dt * (turning[k] + f[3 + k]);
            }
        }
        for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(gained[k], -lost[k], 1e-9 * std::fabs(gained[0])) << k;
        EXPECT_GT(gained[0], 1); // of 137 kg, by a ball at 1 m/s
    }
}

TEST_F(GridViscousBodies, what_moves_as_one_rigid_body_goes_on) {
    auto sample = two_bodies(1e4);
    const Vec3 u{0.3, -0.2, 0.1}, w{0.5, -1, 0.7};
    const auto velocity = [=](const Vec3& x) {
        return Vec3{
            u[0] + w[1] * x[2] - w[2] * x[1], u[1] + w[2] * x[0] - w[0] * x[2], u[2] + w[0] * x[1] - w[1] * x[0]};
    };
    for (auto& body : sample.bodies.bodies) {
        body.velocity = velocity(body.centre);
        body.angular_velocity = w;
    }
    sample.options.residual = 1e-11;
    ViscousCase run(comm, sample);
    run.set_velocity([&](int a, const Vec3& x) { return velocity(x)[static_cast<std::size_t>(a)]; });
    EXPECT_EQ(run.solve(0.01).solve.iterations, 0);
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(run.bodies.velocity(0)[k], sample.bodies.bodies[0].velocity[k], 1e-9);
}

TEST_F(GridViscousBodies, a_stiff_liquid_takes_a_body_along_where_weak_coupling_lags) {
    // At rest, liquid in motion: after a step of a liquid that hardly strains both have their common velocity.
    const auto speed = [&](Coupling coupling) {
        auto sample = two_bodies(1e6);
        sample.body.pop_back();
        sample.bodies.bodies.pop_back();
        sample.bodies.bodies[0].velocity = {0, 0, 0};
        sample.coupling = coupling;
        ViscousCase run(comm, sample);
        run.set_velocity([](int a, const Vec3&) { return a == 1 ? 1.0 : 0.0; });
        run.solve(0.01);
        return run.bodies.velocity(0)[1];
    };
    const double strong = speed(Coupling::strong);
    EXPECT_GT(strong, 0.5); // 30 kg beside 125 kg: 0.8, less what both turn about each other
    EXPECT_LT(strong, 0.8);
    EXPECT_LT(speed(Coupling::weak), 0.5 * strong);
    EXPECT_EQ(speed(Coupling::one_way), 0);
}

TEST_F(GridViscousBodies, strong_coupling_takes_few_more_iterations_than_one_way) {
    for (const double viscosity : {1e3, 1e6}) {
        const auto iterations = [&](Coupling coupling) {
            auto sample = two_bodies(viscosity);
            sample.options.residual = 1e-8;
            sample.coupling = coupling;
            ViscousCase run(comm, sample);
            run.set_noise();
            return run.solve(0.01).solve.iterations;
        };
        const int one_way = iterations(Coupling::one_way), strong = iterations(Coupling::strong);
        EXPECT_LE(strong, one_way + 4) << viscosity; // 13 and 14, 15 and 15
    }
}

TEST_F(GridViscousBodies, locked_degrees_of_freedom_stay) {
    auto sample = two_bodies(1e3);
    for (auto& body : sample.bodies.bodies) {
        body.locked = {true, true, true, true, true, false};
        body.velocity = body.angular_velocity = {0, 0, 0};
    }
    ViscousCase run(comm, sample);
    run.set_velocity([](int a, const Vec3& x) { return a == 0 ? -x[1] : a == 1 ? x[0] : 0.3; });
    run.solve(0.1);
    for (std::size_t b = 0; b < 2; ++b) {
        EXPECT_GT(std::fabs(run.bodies.spin(b)[2]), 0.1);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(run.bodies.velocity(b)[k], 0);
        for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(run.bodies.spin(b)[k], 0);
    }
}

TEST_F(GridViscousBodies, torque_between_cylinders_is_that_of_taylor_and_couette) {
    const Vec3 middle{0.513, 0.491, 0};
    const double inner = 0.2, outer = 0.4, spin = 1.5, viscosity = 1000;
    ViscousSample sample;
    sample.cells = 80; // 16 in the gap
    sample.dimensions = 2;
    sample.solid = [=](const Vec3& x) { return outer - std::hypot(x[0] - middle[0], x[1] - middle[1]); };
    sample.body = {[=](const Vec3& x) { return std::hypot(x[0] - middle[0], x[1] - middle[1]) - inner; }};
    auto body = make_body(middle, 1e12, 1); // so heavy that it hardly changes its motion
    body.angular_velocity = {0, 0, spin};
    sample.bodies = world({body}, 2);
    sample.viscosity = [=](const Vec3&) { return viscosity; };
    sample.options.residual = 1e-11;
    ViscousCase run(comm, sample);
    const double dt = 1e4; // no inertia is left in the liquid
    const double before = run.bodies.angular_momentum(0)[2];
    run.solve(dt);
    const double torque = (before - run.bodies.angular_momentum(0)[2]) / dt;
    const double expected =
        4 * std::numbers::pi * viscosity * spin * inner * inner * outer * outer / (outer * outer - inner * inner);
    EXPECT_NEAR(torque, expected, 0.05 * expected);
}

// Lamb, Hydrodynamics, 334: 8 pi eta omega R1^3 R2^3 / (R2^3 - R1^3).
TEST_F(GridViscousBodies, torque_on_a_sphere_that_turns_within_another_is_right) {
    const Vec3 middle{0.513, 0.491, 0.502};
    const double inner = 0.2, outer = 0.45, spin = 1.5, viscosity = 1000;
    const auto from_middle = [=](const Vec3& x) {
        return std::hypot(x[0] - middle[0], x[1] - middle[1], x[2] - middle[2]);
    };
    ViscousSample sample;
    sample.cells = 32; // 6.4 in the inner radius
    sample.solid = [=](const Vec3& x) { return outer - from_middle(x); };
    sample.body = {[=](const Vec3& x) { return from_middle(x) - inner; }};
    auto body = make_body(middle, 1e12, 1); // so heavy that it hardly changes its motion
    body.angular_velocity = {0.6 * spin, 0, 0.8 * spin};
    sample.bodies = world({body}, 3);
    sample.viscosity = [=](const Vec3&) { return viscosity; };
    sample.options.residual = 1e-11;
    ViscousCase run(comm, sample);
    const double dt = 1e4; // no inertia is left in the liquid
    const auto before = run.bodies.angular_momentum(0);
    run.solve(dt);
    const auto after = run.bodies.angular_momentum(0);
    const double r3 = inner * inner * inner, s3 = outer * outer * outer;
    const double expected = 8 * std::numbers::pi * viscosity * spin * r3 * s3 / (s3 - r3);
    const Vec3 axis{0.6, 0, 0.8};
    double torque = 0;
    for (std::size_t k = 0; k < 3; ++k) torque += axis[k] * (before[k] - after[k]) / dt;
    EXPECT_NEAR(torque, expected, 0.05 * expected);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR((before[k] - after[k]) / dt, axis[k] * torque, 0.01 * expected);
    RecordProperty("off_per_mille", static_cast<int>(std::lround(1000 * (torque / expected - 1))));
}

} // namespace
} // namespace treacle::grid::viscous_bodies_test
