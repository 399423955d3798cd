#include "scenes.hpp"

// Bodies that slide and roll over floors that consist of parts.
namespace treacle::rigid::sliding_test {
namespace {
constexpr double pi = std::numbers::pi;
constexpr double dt = 4e-3; // [s]

BodiesSetup on(const Floor& floor, const BodySetup& body, const Tilt& tilt, double friction) {
    auto bodies = floor.parts;
    bodies.push_back(body);
    for (auto& one : bodies) one.friction = friction;
    auto setup = world(std::move(bodies), tilt.dimensions);
    setup.gravity[tilt.up()] = -gravity;
    return setup;
}
double speed_of(const RigidBodies& bodies, const Tilt& tilt) {
    return dot(bodies.velocity(bodies.size() - 1), tilt.along());
}
double height_of(const RigidBodies& bodies, const Tilt& tilt) {
    return dot(bodies.pose(bodies.size() - 1).centre, tilt.upwards());
}

} // namespace

TEST(Sliding, WithoutFrictionABoxGlidesOverSeamsAndEdgesWithinForEver) {
    for (const int dimensions : {2, 3}) {
        const Tilt tilt{dimensions, 0};
        for (const auto& floor : floors(tilt)) {
            auto brick = make_body(tilt.box(-0.9, -0.7, 0, 0.1), dimensions);
            brick.velocity = {1, 0, 0};
            RigidBodies bodies(on(floor, brick, tilt, 0));
            run(bodies, dt, 300);
            // Nothing but round-off of the contacts' normals.
            EXPECT_NEAR(speed_of(bodies, tilt), 1, 1e-9) << floor.name << ' ' << dimensions;
            EXPECT_NEAR(height_of(bodies, tilt), 0.05, 0.006 * 0.05) << floor.name << ' ' << dimensions;
        }
    }
}

TEST(Sliding, ABoxOnASlopeHasTheAccelerationOfItsFriction) {
    for (const int dimensions : {2, 3}) {
        const Tilt tilt{dimensions, 25 * pi / 180};
        for (const auto& floor : floors(tilt)) {
            for (const double friction : {0.0, 0.2}) {
                auto brick = make_body(tilt.box(-0.9, -0.7, 0, 0.1), dimensions);
                RigidBodies bodies(on(floor, brick, tilt, friction));
                run(bodies, dt, 120);
                const double expected =
                    std::max(0.0, gravity * (std::sin(tilt.angle) - friction * std::cos(tilt.angle)));
                EXPECT_NEAR(speed_of(bodies, tilt) / bodies.time(), expected, 0.01 * expected + 1e-9)
                    << floor.name << ' ' << dimensions << " friction " << friction;
            }
        }
    }
}

TEST(Sliding, BallsCylindersAndDiscsRollDownASlope) {
    const Tilt space{3, 0.2}, plane{2, 0.2};
    auto roller = [](scene::ShapeKind kind, const Tilt& tilt, double height) {
        scene::Shape shape;
        shape.kind = kind;
        shape.radius = 0.1;
        shape.height = height;
        shape.axis = {0, tilt.dimensions == 3 ? 1.0 : 0.0, tilt.dimensions == 3 ? 0.0 : 1.0};
        shape.centre = -0.6 * tilt.along() + 0.1 * tilt.upwards();
        return shape;
    };
    struct Case {
        std::string name;
        Tilt tilt;
        scene::Shape shape;
        double fraction; // of g sin, without sliding
    };
    const std::vector<Case> cases{{"ball", space, roller(scene::ShapeKind::sphere, space, 0), 5.0 / 7},
        {"cylinder", space, roller(scene::ShapeKind::cylinder, space, 0.2), 2.0 / 3},
        {"thin disc", space, roller(scene::ShapeKind::cylinder, space, 0.02), 2.0 / 3},
        {"disc in the plane", plane, roller(scene::ShapeKind::sphere, plane, 0), 2.0 / 3}};
    for (const auto& one : cases) {
        for (const auto& floor : floors(one.tilt)) {
            auto body = make_body(one.shape, one.tilt.dimensions);
            RigidBodies bodies(on(floor, body, one.tilt, 0.5));
            run(bodies, dt, 150);
            const double expected = one.fraction * gravity * std::sin(one.tilt.angle);
            EXPECT_NEAR(speed_of(bodies, one.tilt) / bodies.time(), expected, 0.01 * expected)
                << one.name << " on " << floor.name;
            EXPECT_NEAR(height_of(bodies, one.tilt), 0.1, 0.02 * 0.05) << one.name << " on " << floor.name;
        }
    }
}

TEST(Sliding, ABoxStopsAtAWallThatStandsOnTheFloorAndAtAStep) {
    for (const int dimensions : {2, 3}) {
        const Tilt tilt{dimensions, 0};
        // The floor goes on below the wall; the wall begins where the floor ends; a step of 5 mm.
        const std::vector<std::array<double, 3>> walls{{1.0, 0.0, 0.5}, {0.5, -0.2, 0.5}, {0.5, -0.2, 0.005}};
        for (const auto& [end, low, high] : walls) {
            Floor floor{"", {make_static(tilt.box(-1, end, -0.2, 0), dimensions),
                                make_static(tilt.box(0.5, 1, low, high), dimensions)}};
            auto brick = make_body(tilt.box(0, 0.2, 0, 0.1), dimensions);
            brick.velocity = {1, 0, 0};
            RigidBodies bodies(on(floor, brick, tilt, 0));
            run(bodies, dt, 150);
            if (high < 0.1) {
                EXPECT_LT(bodies.pose(2).centre[0], 0.41) << "it trips over the step";
                continue;
            }
            EXPECT_NEAR(bodies.pose(2).centre[0], 0.4, 0.02 * 0.05) << end << ' ' << high;
            EXPECT_NEAR(speed_of(bodies, tilt), 0, 1e-6);
        }
    }
}

TEST(Sliding, BarsThatCrossTouchAtTheirEdges) {
    // Both lie on an edge of their own; the lower one is held. The point where they cross is no sample.
    for (const double beside : {0.0, 0.013}) {
        auto lower = box({-0.3, -0.05, -0.05}, {0.3, 0.05, 0.05}), upper = box({-0.05, -0.3, -0.05}, {0.05, 0.3, 0.05});
        lower.rotation_axis = {1, 0, 0};
        upper.rotation_axis = {0, 1, 0};
        lower.rotation_angle = upper.rotation_angle = pi / 4;
        const double half = 0.05 * std::sqrt(2.0);
        const Vec3 shift{beside, 0.007, 2 * half + 0.02};
        for (std::size_t k = 0; k < 3; ++k) upper.min[k] += shift[k], upper.max[k] += shift[k];
        auto fixed = make_static(lower, 3), bar = make_body(upper);
        bar.velocity = {0, 0, -1};
        bar.restitution = 1;
        RigidBodies bodies(world({fixed, bar}));
        run(bodies, 1e-3, 40);
        // Off its middle by 7 mm it turns a little.
        const double fraction = 1 / (1 + bar.mass * 0.007 * 0.007 / bar.inertia[0][0]);
        EXPECT_NEAR(bodies.velocity(1)[2], 2 * fraction - 1, 0.02) << beside;
        EXPECT_NEAR(bodies.velocity(1)[0], 0, 1e-3);
    }
}

} // namespace treacle::rigid::sliding_test
