#include "sample.hpp"

namespace treacle::rigid::contact_test {
namespace {
constexpr double dt = 1e-3; // [s]
}

TEST(Contact, ABallBouncesWithItsRestitution) {
    for (const double restitution : {0.0, 0.5, 1.0}) {
        auto drop = make_body(ball({0, 0, 0.6}, 0.1));
        drop.restitution = restitution;
        RigidBodies bodies(on_floor({drop}));
        double fastest = 0, after = 0;
        for (int k = 0; k < 400 && after == 0; ++k) {
            run(bodies, dt, 1);
            fastest = std::min(fastest, bodies.velocity(0)[2]);
            if (bodies.velocity(0)[2] > fastest + 1) after = bodies.velocity(0)[2];
        }
        // It falls 0.5 m. What gravity gives in the step of the impact is not known better.
        EXPECT_NEAR(-fastest, std::sqrt(2 * gravity * 0.5), 2 * gravity * dt);
        if (restitution > 0) {
            EXPECT_NEAR(after / -fastest, restitution, 2 * gravity * dt / -fastest);
        } else {
            run(bodies, dt, 200);
            EXPECT_NEAR(bodies.pose(0).centre[2], 0.1, 0.01 * 0.05) << "lies on the floor";
        }
    }
}

TEST(Contact, AStackOfTwoBoxesRests) {
    for (const int dimensions : {2, 3}) {
        const auto up = static_cast<std::size_t>(dimensions - 1);
        const auto cube = [&](double height) {
            Vec3 lo{0, 0, 0}, hi{0.2, 0.2, 0.2};
            if (dimensions == 2) lo[2] = -1, hi[2] = 1;
            lo[up] = height;
            hi[up] = height + 0.2;
            auto body = make_body(box(lo, hi), dimensions);
            body.friction = 0.5;
            return body;
        };
        RigidBodies bodies(on_floor({cube(0), cube(0.2)}, dimensions));
        run(bodies, dt, 2000);
        for (std::size_t b = 0; b < 2; ++b) {
            EXPECT_LT(length(bodies.velocity(b)), 1e-6);
            EXPECT_LT(length(rotation_vector(bodies.pose(b).turn)), 1e-3);
            // Overlaps of 0.005 spacings are left alone.
            EXPECT_NEAR(bodies.pose(b).centre[up], 0.1 + 0.2 * double(b), 0.02 * 0.05);
        }
        EXPECT_GT(bodies.contacts(), 2);
    }
}

TEST(Contact, FrictionStopsASlidingBoxAfterItsKnownWay) {
    auto brick = make_body(box({0, 0, 0}, {0.4, 0.4, 0.1}));
    brick.velocity = {1, 0, 0};
    brick.friction = 0.3;
    RigidBodies bodies(on_floor({brick}));
    run(bodies, dt, 1000);
    EXPECT_NEAR(length(bodies.velocity(0)), 0, 1e-9);
    const double way = 1 / (2 * 0.3 * gravity);
    EXPECT_NEAR(bodies.pose(0).centre[0] - 0.2, way, 0.01 * way);
    EXPECT_NEAR(bodies.pose(0).centre[1], 0.2, 1e-6);
}

TEST(Contact, WithoutFrictionABoxSlidesOn) {
    auto brick = make_body(box({0, 0, 0}, {0.4, 0.4, 0.1}));
    brick.velocity = {1, 0, 0};
    RigidBodies bodies(on_floor({brick}));
    run(bodies, dt, 500);
    EXPECT_NEAR(bodies.velocity(0)[0], 1, 1e-9);
}

// The lower edge touches first, and the box turns onto the other one within the same step.
TEST(Contact, ABoxThatTurnsOntoAFaceLandsOnAllOfIt) {
    constexpr double tilt = 0.01, turn = 0.04, step = 0.01; // [rad], [rad], [s]
    const double height = 0.2 * std::sin(tilt);
    for (const bool on_box : {false, true}) {
        auto shape = box({-0.2, -0.2, height}, {0.2, 0.2, height + 0.1});
        shape.centre = {0, 0, height + 0.05};
        shape.rotation_axis = {0, 1, 0};
        shape.rotation_angle = tilt;
        auto brick = make_body(shape);
        brick.angular_velocity = {0, -turn / step, 0};
        auto setup = world({brick});
        if (on_box) {
            auto slab = make_body(box({-1, -1, -0.2}, {1, 1, 0}));
            slab.kind = scene::BodyKind::fixed;
            setup.bodies.push_back(slab);
        } else {
            setup.walls = {{2, 0, 1}};
        }
        RigidBodies bodies(setup);
        run(bodies, step, 1);
        double lowest = 1;
        const auto& solid = setup.bodies[0];
        const auto axes = to_matrix(bodies.pose(0).turn);
        for (const auto& probe : solid.probes)
            lowest = std::min(lowest, (bodies.pose(0).centre + axes * (probe.point - solid.centre))[2]);
        // Along straight lines, off by half the square of the angle times 0.2 m; 4 mm where only the lower edge counts.
        EXPECT_GT(lowest, -0.5 * turn * turn * 0.2) << on_box;
    }
}

TEST(Contact, BodiesThatCollideKeepTheirMomentum) {
    auto left = make_body(ball({0, 0, 0}, 0.1)), right = make_body(box({0.3, -0.07, -0.1}, {0.5, 0.1, 0.12}));
    left.velocity = {2, 0.1, 0};
    left.restitution = 0.7;
    left.friction = right.friction = 0.4;
    RigidBodies bodies(world({left, right}));
    const auto before = bodies.momentum();
    run(bodies, dt, 300);
    const auto after = bodies.momentum();
    EXPECT_GT(bodies.velocity(1)[0], 0.1) << "they did meet";
    EXPECT_GT(length(bodies.spin(1)), 0.01) << "off the middle";
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(after[k], before[k], 1e-12 * before[0]);
}

TEST(Contact, ABallInAHollowBodyStaysInIt) {
    auto drum = make_body(ball({0, 0, 0}, 0.5));
    drum.kind = scene::BodyKind::fixed;
    auto shape = ball({0, 0, 0}, 0.5);
    shape.inverted = true;
    drum.region = {scene::SolidRegion(shape)};
    drum.probes.clear();
    auto pearl = make_body(ball({0.3, 0, 0}, 0.05));
    pearl.friction = 0;
    auto setup = world({drum, pearl});
    setup.gravity = {0, 0, -gravity};
    RigidBodies bodies(setup);
    for (int k = 0; k < 2000; ++k) {
        run(bodies, dt, 1);
        ASSERT_LT(length(bodies.pose(1).centre), 0.45 + 0.05 * 0.05);
    }
}

TEST(Contact, BodiesMeetAcrossAPeriodicSide) {
    auto left = make_body(ball({0.15, 0, 0}, 0.1)), right = make_body(ball({0.85, 0, 0}, 0.1));
    left.velocity = {-1, 0, 0};
    auto setup = world({left, right});
    setup.period = {1, 0, 0};
    RigidBodies bodies(setup);
    run(bodies, dt, 300);
    EXPECT_LT(bodies.velocity(1)[0], -0.1);
}

} // namespace treacle::rigid::contact_test
