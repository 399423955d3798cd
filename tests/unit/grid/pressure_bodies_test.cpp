#include "pressure_sample.hpp"

#include <gtest/gtest.h>

namespace treacle::grid::pressure_bodies_test {
namespace {

constexpr double dt = 1e-2; // [s]
const Vec3 gravity{0, 0, -9.81};

double from(const Vec3& centre, const Vec3& x) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += (x[k] - centre[k]) * (x[k] - centre[k]);
    return std::sqrt(sum);
}

rigid::BodySetup free_body(const Vec3& centre, double mass, double radius) {
    rigid::BodySetup body;
    body.kind = scene::BodyKind::dynamic;
    body.centre = centre;
    body.mass = mass;
    for (std::size_t k = 0; k < 3; ++k) body.inertia[k][k] = 0.4 * mass * radius * radius;
    body.bounding_radius = radius;
    return body;
}

// An egg in a pool, and its mass over that of the liquid it displaces.
PressureSample egg_in_a_pool(double ratio) {
    PressureSample sample;
    sample.options.residual = 1e-13;
    sample.liquid = [](const Vec3& x) { return x[2] - 0.81; };
    const Vec3 centre{0.47, 0.52, 0.43};
    const double radius = 0.2;
    sample.body = [=](const Vec3& x) {
        const Vec3 squeezed{centre[0] + 0.8 * (x[0] - centre[0]) + 0.3 * (x[2] - centre[2]), x[1], x[2]};
        return from(centre, squeezed) - radius;
    };
    sample.bodies.bodies = {
        free_body(centre, ratio * 1000 / 0.8 * 4.0 / 3 * math::pi * radius * radius * radius, radius)};
    sample.bodies.gravity = gravity;
    sample.bodies.spacing = 1.0 / sample.cells;
    return sample;
}

class BodiesInLiquid : public testing::Test {
protected:
    const Comm comm = Comm::world();
};

// The volume that the body takes of the faces across z.
double displaced(const PressureCase& test) {
    double sum = 0;
    test.each_owned([&](std::size_t at, const int*) {
        const auto& of = test.body_fractions[2];
        for (int k = of.first(at); k < of.first(at + 1); ++k) sum += of.fraction(static_cast<std::size_t>(k));
    });
    return test.decomposition.comm().sum(sum) * std::pow(test.grid.dx, 3);
}

TEST_F(BodiesInLiquid, AsHeavyAsItFloatAtRest) {
    auto sample = egg_in_a_pool(1);
    sample.bodies.bodies[0].mass = 1000 * displaced(PressureCase(comm, sample));
    sample.bodies.bodies[0].locked = {false, false, false, true, true, true}; // its shares' middle is not its centre
    PressureCase test(comm, sample);
    test.bodies.begin(dt);
    test.bodies.fall(dt);
    test.build();
    test.accelerate(gravity, dt);
    test.project(dt);
    EXPECT_LT(test.max_speed(), 1e-9);
    EXPECT_LT(std::fabs(test.bodies.velocity(0)[2]), 1e-9);
}

// All that moves: momenta of faces by the mass that the projection gives them, A theta rho dx^3, and of the body.
std::array<double, 6> momentum(const PressureCase& test) {
    std::array<double, 6> sum{};
    const auto& faces = test.pressure.system().faces();
    test.each_owned([&](std::size_t at, const int c[3]) {
        for (int a = 0; a < test.grid.dimensions; ++a) {
            const auto before = test.below(a, at);
            if (!test.wet(at) && !test.wet(before)) continue;
            double mass = 1000 * std::pow(test.grid.dx, 3) * faces.open(a, at);
            if (!test.wet(at)) mass *= faces.theta(before, at);
            if (!test.wet(before)) mass *= faces.theta(at, before);
            add_load(a, test.face(a, c).data(), mass * test.velocity.axis[a](at), sum.data());
        }
    });
    test.decomposition.comm().sum(std::span(sum));
    const auto body = test.bodies.momentum();
    for (std::size_t k = 0; k < 6; ++k) sum[k] += body[k];
    return sum;
}

TEST_F(BodiesInLiquid, ChangeNoMomentumTogether) {
    for (const double ratio : {0.1, 1.0, 7.0}) {
        auto sample = egg_in_a_pool(ratio);
        // A blob around the egg, nowhere near the walls.
        sample.liquid = [](const Vec3& x) { return from({0.5, 0.5, 0.45}, x) - 0.39; };
        sample.bodies.bodies[0].velocity = {0.3, -1, 0.2};
        sample.bodies.bodies[0].angular_velocity = {2, 1, -3};
        PressureCase test(comm, sample);
        test.bodies.begin(dt);
        test.build();
        test.set_velocity([](int a, const Vec3& x) { return 0.5 + noise(a, x); });
        const auto before = momentum(test);
        test.project(dt);
        const auto after = momentum(test);
        // Round-off, and the solve's residual.
        for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(after[k], before[k], 1e-10 * 1000 * 0.2) << ratio << " " << k;
    }
}

TEST_F(BodiesInLiquid, LeaveNoDivergenceByTheVelocitiesTheyGet) {
    auto sample = egg_in_a_pool(0.2);
    sample.bodies.bodies[0].velocity = {0.3, -1, 0.2};
    PressureCase test(comm, sample);
    test.bodies.begin(dt);
    test.build();
    test.set_velocity(noise);
    test.project(dt);
    test.halo.gather({test.velocity.axis[0], test.velocity.axis[1], test.velocity.axis[2]});
    // A second projection finds nothing to do.
    const auto again = test.project(dt);
    EXPECT_EQ(again.solve.iterations, 0);
}

TEST_F(BodiesInLiquid, AreTheSameOnOneRankAndOnAll) {
    auto sample = egg_in_a_pool(0.4);
    PressureCase together(comm, sample), alone(Comm::self(), sample);
    for (auto* test : {&together, &alone}) {
        test->bodies.begin(dt);
        test->build();
        test->set_velocity(noise);
        test->project(dt);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(together.bodies.velocity(0)[k], alone.bodies.velocity(0)[k], 1e-9); // the residuals
        EXPECT_NEAR(together.bodies.spin(0)[k], alone.bodies.spin(0)[k], 1e-9);
    }
}

TEST_F(BodiesInLiquid, FeelNothingInOneWayCoupling) {
    auto sample = egg_in_a_pool(0.2);
    sample.coupling = Coupling::one_way;
    PressureCase test(comm, sample);
    test.bodies.begin(dt);
    test.bodies.fall(dt);
    test.build();
    test.accelerate(gravity, dt);
    test.project(dt);
    EXPECT_DOUBLE_EQ(test.bodies.velocity(0)[2], gravity[2] * dt);
}

TEST_F(BodiesInLiquid, TooLightAreThrownByWeakCouplingAndNotByStrong) {
    for (const auto coupling : {Coupling::weak, Coupling::strong}) {
        auto sample = egg_in_a_pool(0.05);
        sample.coupling = coupling;
        PressureCase test(comm, sample);
        test.bodies.begin(dt);
        test.bodies.fall(dt);
        test.build();
        test.accelerate(gravity, dt);
        test.project(dt);
        const double rise = test.bodies.velocity(0)[2] / (-gravity[2] * dt);
        // Alone it would rise with (1 - 0.05) / 0.05 g; with the liquid that it must move, below (1 - 0.05) / (0.05 + 1/2) g.
        if (coupling == Coupling::weak) {
            EXPECT_GT(rise, 5);
        }
        if (coupling == Coupling::strong) {
            EXPECT_LT(rise, 1.8);
        }
        EXPECT_GT(rise, 0.5);
    }
}

// A box full of liquid below a body of 250 kg that closes it.
PressureSample box_below_a_lid() {
    PressureSample sample;
    sample.options.residual = 1e-13;
    const double level = 0.71;
    sample.liquid = [=](const Vec3& x) { return x[2] - level - 0.02; };
    sample.body = [=](const Vec3& x) { return level - x[2]; };
    sample.bodies.bodies = {free_body({0.5, 0.5, 0.9}, 250, 0.2)};
    sample.bodies.gravity = gravity;
    sample.bodies.spacing = 1.0 / sample.cells;
    return sample;
}

// Gravity on all for a step [s], and the pressure.
PressureReport fall(PressureCase& test, double step) {
    test.bodies.begin(step);
    test.bodies.fall(step);
    test.build();
    test.accelerate(gravity, step);
    return test.project(step);
}

// A piston without weight of its own closes a box of liquid: the constant of the pressure carries it.
TEST_F(BodiesInLiquid, ThatCloseABoxAreCarriedByTheConstantOfThePressure) {
    auto sample = box_below_a_lid();
    sample.bodies.bodies[0].locked = {true, true, false, true, true, true};
    PressureCase test(comm, sample);
    const auto report = fall(test, dt);
    EXPECT_EQ(report.closed, 1);
    EXPECT_LT(std::fabs(test.bodies.velocity(0)[2]), 1e-9);
    EXPECT_LT(test.max_speed(), 1e-9);
    EXPECT_NEAR(report.loads[2], 250 * 9.81, 1e-5);
}

// A lid on a hinge closes a box of liquid: turned about its edge it gives way to the constant of the pressure;
// about an axle through its middle, to which a constant pressure has no arm, it does not, and the box must balance.
TEST_F(BodiesInLiquid, OnHingesCloseABoxByWhereTheHingeIs) {
    const double shorter = 1e-2 * dt; // in which the hinge's chord is a straight line to 1e-8
    for (const double axle : {0.0, 0.5}) {
        SCOPED_TRACE(axle);
        auto sample = box_below_a_lid();
        rigid::JointSetup hinge;
        hinge.point = {axle, 0.5, 0.9};
        hinge.axis = {0.6, 0.8, 0};
        sample.bodies.joints = {hinge};
        PressureCase test(comm, sample);
        const auto report = fall(test, shorter);
        EXPECT_EQ(report.closed, 1);
        EXPECT_TRUE(report.solve.converged());
        EXPECT_LT(test.max_speed(), 1e-8);
        const double arm = 0.8 * (0.5 - axle);
        EXPECT_NEAR(arm * report.loads[2] - 0.6 * report.loads[3] - 0.8 * report.loads[4], arm * 250 * 9.81, 1e-4);
    }
}

// A piston closes two boxes side by side: with only one motion for two constants, one of them stays free.
TEST_F(BodiesInLiquid, CloseTwoBoxesByOneMotion) {
    auto sample = box_below_a_lid();
    sample.solid = [](const Vec3& x) { return std::fabs(x[0] - 0.4) - 0.07; };
    sample.bodies.bodies[0].locked = {true, true, false, true, true, true};
    PressureCase test(comm, sample);
    const auto report = fall(test, dt);
    EXPECT_EQ(report.closed, 2);
    EXPECT_LT(report.incompatible_fraction, 1e-12);
    EXPECT_LT(std::fabs(test.bodies.velocity(0)[2]), 1e-9);
    EXPECT_LT(test.max_speed(), 1e-9);
    EXPECT_NEAR(report.loads[2], 250 * 9.81, 1e-5);
}

// Parts of liquid that push one body along x, along y, or not at all.
TEST(PartRelief, TakesOffWhatNoMotionOfBodiesCan) {
    rigid::Response response;
    for (std::size_t k = 0; k < 3; ++k) response.linear[k][k] = response.angular[k][k] = 0.5;
    const std::vector<double> x{2, 0, 0, 0, 0, 0}, y{0, 1, 0, 0, 0, 0}, none(6, 0.0);
    const auto surplus = [&](const std::vector<std::vector<double>>& pushes, const std::vector<double>& sums,
                             const std::vector<double>& sizes) {
        std::vector<double> net;
        for (const auto& push : pushes) net.insert(net.end(), push.begin(), push.end());
        PartRelief relief;
        relief.find(rigid::ConstrainedInverseMass({response}, {}), pushes.size(), net, net);
        return relief.surplus(sums, sizes);
    };
    const auto same = [](const std::vector<double>& found, const std::vector<double>& expected) {
        for (std::size_t p = 0; p < expected.size(); ++p) EXPECT_NEAR(found[p], expected[p], 1e-14);
    };
    same(surplus({none, none}, {3, 5}, {2, 4}), {1.5, 1.25}); // walls alone: the means
    same(surplus({x, y, none}, {3, 5, 2}, {2, 4, 8}), {0, 0, 0.25});
    same(surplus({x, x}, {3, 1}, {2, 2}), {0.5, -0.5});
    same(surplus({x, y, x}, {3, 7, 1}, {2, 1, 2}), {0.5, 0, -0.5});
}

} // namespace
} // namespace treacle::grid::pressure_bodies_test
