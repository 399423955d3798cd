#include "sample.hpp"

namespace treacle::rigid::motion_test {
namespace {

constexpr double pi = std::numbers::pi;

scene::Keyframe keyframe(double time, const Vec3& shift, const Vec3& axis, double angle) {
    scene::Keyframe frame;
    frame.time = time;
    frame.translation = shift;
    frame.rotation_axis = axis;
    frame.rotation_angle = angle;
    return frame;
}

} // namespace

TEST(FreeBody, KeepsItsMomentumExactlyAndItsEnergy) {
    auto brick = make_body(box({0, 0, 0}, {0.2, 0.3, 0.5}));
    brick.velocity = {0.3, 0, -0.1};
    brick.angular_velocity = {0.01, 8, 0.02}; // the middle axis: it tumbles
    RigidBodies bodies(world({brick}));
    const auto momentum = bodies.momentum();
    const double energy = bodies.energy()[0];
    double turned_over = 0;
    for (int k = 0; k < 4000; ++k) {
        run(bodies, 1e-3, 1);
        turned_over = std::min(turned_over, to_matrix(bodies.pose(0).turn)[1][1]);
    }
    const auto now = bodies.momentum();
    // Not one operation touches the linear and the spin momentum; the lever arm of the former is round-off.
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(now[k], momentum[k], 1e-12 * std::abs(momentum[4]));
    EXPECT_LT(turned_over, -0.9) << "it did tumble";
    // Third order in 8 rad/s times 1 ms, over 4000 steps.
    EXPECT_NEAR(bodies.energy()[0], energy, 1e-4 * energy);
}

TEST(FreeBody, FallsAsItShouldAndInThePlaneStaysInIt) {
    auto brick = make_body(box({0, 0, -1}, {0.2, 0.3, 1}), 2);
    brick.angular_velocity = {0, 0, 3};
    auto setup = world({brick}, 2);
    setup.gravity = {0, -gravity, 0};
    RigidBodies bodies(setup);
    run(bodies, 1e-3, 500);
    // Symplectic Euler is late by half a step.
    EXPECT_NEAR(bodies.pose(0).centre[1], 0.15 - 0.5 * gravity * 0.5 * 0.501, 1e-12);
    EXPECT_EQ(bodies.pose(0).centre[2], 0);
    EXPECT_NEAR(rotation_vector(bodies.pose(0).turn)[2], 1.5, 1e-9);
    EXPECT_EQ(rotation_vector(bodies.pose(0).turn)[0], 0);
}

TEST(FreeBody, FliesExactlyWhenKicksGoFromTheMiddleOfAStepToThatOfTheNext) {
    auto brick = make_body(box({0, 0, 0}, {0.2, 0.3, 0.5}));
    brick.velocity = {1, 0, 2};
    auto setup = world({brick});
    setup.gravity = {0, 0, -gravity};
    RigidBodies bodies(setup);
    double before = 0;
    for (int k = 0; k < 400; ++k) {
        const double dt = k % 3 == 0 ? 0.5e-3 : 1e-3; // of unlike steps as well
        bodies.begin(dt);
        bodies.fall(0.5 * (before + dt));
        bodies.move(before = dt);
    }
    const double t = bodies.time();
    EXPECT_NEAR(bodies.pose(0).centre[0], 0.1 + t, 1e-12);
    EXPECT_NEAR(bodies.pose(0).centre[2], 0.25 + 2 * t - 0.5 * gravity * t * t, 1.1 * gravity * 1e-6)
        << "a mean of unlike steps";
}

TEST(FreeBody, TumblesAtSecondOrderInTheStep) {
    auto brick = make_body(box({0, 0, 0}, {0.2, 0.3, 0.5}));
    brick.angular_velocity = {1, 8, 2};
    const auto turned = [&](double dt) {
        RigidBodies bodies(world({brick}));
        run(bodies, dt, static_cast<int>(std::lround(0.8 / dt)));
        return bodies.pose(0).turn;
    };
    const auto fine = turned(1e-4);
    const auto error = [&](double dt) { return length(rotation_vector(product(turned(dt), conjugate(fine)))); };
    const double coarse = error(8e-3), half = error(4e-3);
    EXPECT_GT(coarse, 1e-6);
    EXPECT_NEAR(std::log2(coarse / half), 2, 0.2);
}

TEST(FreeBody, LoadsGiveTheVelocitiesOfMassAndInertia) {
    RigidBodies bodies(world({make_body(box({0, 0, 0}, {0.2, 0.3, 0.5}))}));
    const double loads[6] = {3, 0, 0, 0, 0, 2};
    bodies.push(loads, 0.1);
    EXPECT_NEAR(bodies.velocity(0)[0], 3 * 0.1 / 30, 1e-12);
    EXPECT_NEAR(bodies.spin(0)[2], 2 * 0.1 / (30.0 / 12 * (0.04 + 0.09)), 1e-9);
}

TEST(LockedBody, MovesOnlyAsItMay) {
    auto brick = make_body(box({0, 0, 0}, {0.2, 0.3, 0.5}));
    brick.locked = {true, false, true, true, true, false};
    brick.velocity = {1, 2, 3};
    RigidBodies bodies(world({brick}));
    const double loads[6] = {1, 1, 1, 1, 1, 1};
    bodies.push(loads, 0.1);
    EXPECT_EQ(bodies.velocity(0)[0], 0);
    EXPECT_EQ(bodies.velocity(0)[2], 0);
    EXPECT_NEAR(bodies.velocity(0)[1], 2 + 0.1 / 30, 1e-12);
    EXPECT_EQ(bodies.spin(0)[0], 0);
    EXPECT_EQ(bodies.spin(0)[1], 0);
    EXPECT_GT(bodies.spin(0)[2], 0);
}

TEST(KinematicBody, FollowsItsKeyframesAndRestsAfterTheLast) {
    auto stirrer = make_body(box({0, 0, 0}, {1, 1, 1}));
    stirrer.kind = scene::BodyKind::kinematic;
    // Three turns in the second second, about the same axis.
    stirrer.keyframes = {keyframe(1, {0.5, 0, 0}, {0, 0, 2}, 0), keyframe(2, {0.5, 1, 0}, {0, 0, 1}, 6 * pi)};
    RigidBodies bodies(world({stirrer}));
    run(bodies, 0.01, 50);
    EXPECT_NEAR(bodies.pose(0).centre[0], 0.75, 1e-12);
    EXPECT_NEAR(bodies.velocity(0)[0], 0.5, 1e-6) << "the velocity ahead";
    run(bodies, 0.01, 75);
    EXPECT_NEAR(bodies.pose(0).centre[1], 0.75, 1e-9);
    EXPECT_NEAR(std::abs(rotation_vector(bodies.pose(0).turn)[2]), pi / 2, 1e-9) << "1.5 pi";
    bodies.begin(0.01);
    EXPECT_NEAR(bodies.spin(0)[2], 6 * pi, 1e-9);
    run(bodies, 0.01, 100);
    EXPECT_NEAR(bodies.pose(0).centre[1], 1.5, 1e-12);
    bodies.begin(0.01);
    EXPECT_NEAR(length(bodies.spin(0)) + length(bodies.velocity(0)), 0, 1e-12);
}

TEST(KinematicBody, TakesTheShorterWayBetweenOtherAxes) {
    const std::vector<scene::Keyframe> frames{
        keyframe(1, {0, 0, 0}, {1, 0, 0}, pi / 2), keyframe(2, {0, 0, 0}, {0, 1, 0}, pi / 2)};
    const auto first = interpolate(frames, 0.5), end = interpolate(frames, 2);
    EXPECT_NEAR(rotation_vector(first.turn)[0], pi / 4, 1e-12);
    EXPECT_NEAR(rotation_vector(end.turn)[1], pi / 2, 1e-12);
    const auto from = interpolate(frames, 1).turn, middle = interpolate(frames, 1.5).turn;
    const double half = length(rotation_vector(product(middle, conjugate(from))));
    EXPECT_NEAR(length(rotation_vector(product(end.turn, conjugate(from)))), 2 * half, 1e-12);
    EXPECT_NEAR(2 * half, 2 * pi / 3, 1e-12);
}

TEST(Bodies, ARestoredStateGoesOnBitForBitBetweenImpacts) {
    auto drop = make_body(box({0, 0, 0.1}, {0.2, 0.3, 0.6})), brick = make_body(box({0, 0, 0}, {0.2, 0.3, 0.05}));
    drop.restitution = 0.9;
    drop.friction = brick.friction = 0.4;
    drop.angular_velocity = {1, 2, 3};
    RigidBodies straight(on_floor({drop, brick}));
    run(straight, 1e-3, 250);
    RigidBodies resumed(on_floor({drop, brick}));
    resumed.restore(straight.state());
    run(straight, 1e-3, 250);
    run(resumed, 1e-3, 250);
    EXPECT_EQ(straight.state(), resumed.state());
}

TEST(Bodies, ARestoredStateGoesOnBitForBit) {
    auto brick = make_body(box({0, 0, 1}, {0.2, 0.3, 1.5}));
    brick.angular_velocity = {1, 2, 3};
    RigidBodies straight(on_floor({brick}));
    run(straight, 1e-3, 300);
    RigidBodies resumed(on_floor({brick}));
    resumed.restore(straight.state());
    run(straight, 1e-3, 300);
    run(resumed, 1e-3, 300);
    EXPECT_EQ(straight.state(), resumed.state());
}

} // namespace treacle::rigid::motion_test
