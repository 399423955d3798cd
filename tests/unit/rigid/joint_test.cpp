#include "base/text/error.hpp"
#include "sample.hpp"

namespace treacle::rigid::joint_test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double dt = 1e-3; // [s]

JointSetup joint_of(
    scene::JointKind kind, std::size_t body, int other, const Vec3& point, const Vec3& axis = {0, 0, 1}) {
    JointSetup joint;
    joint.name = "link";
    joint.kind = kind;
    joint.body = body;
    joint.other = other;
    joint.point = point;
    joint.axis = axis;
    joint.length_scale = 0.3;
    return joint;
}

// A brick that hangs from its upper end, turned by `angle` about y (in the plane about z).
BodiesSetup pendulum(scene::JointKind kind, double angle, int dimensions = 3) {
    const auto up = static_cast<std::size_t>(dimensions - 1);
    scene::Shape shape = box({-0.05, -0.04, -0.04}, {0.05, 0.04, 0.04});
    shape.min[up] = -0.4;
    shape.max[up] = 0;
    if (dimensions == 2) shape.min[2] = -1, shape.max[2] = 1;
    for (std::size_t k = 0; k < 3; ++k) shape.centre[k] = 0.5 * (shape.min[k] + shape.max[k]);
    const Vec3 axis = dimensions == 3 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
    shape.rotation_axis = axis;
    shape.rotation_angle = angle;
    auto setup = world({make_body(shape, dimensions)}, dimensions);
    setup.gravity[up] = -gravity;
    // Where the middle of the upper end is.
    Vec3 end{0, 0, 0};
    end[up] = 0.2;
    setup.joints = {joint_of(kind, 0, -1, shape.centre + to_matrix(rotation_by(angle * axis)) * end, axis)};
    return setup;
}

// Of a physical pendulum about the end of it [rad/s].
double pulsation(const BodiesSetup& setup, std::size_t axis) {
    const auto& body = setup.bodies[0];
    const double length = 0.2;
    return std::sqrt(body.mass * gravity * length / (body.inertia[axis][axis] + body.mass * length * length));
}

// Seconds between the first and the last time that the body passes the vertical in the same direction, per
// swing.
double period_of(RigidBodies& bodies, std::size_t across, int swings) {
    const double hang = bodies.setup().joints[0].point[across];
    double first = 0, last = bodies.pose(0).centre[across] - hang;
    for (int found = -1, k = 0; k < 100000; ++k) {
        run(bodies, dt, 1);
        const double now = bodies.pose(0).centre[across] - hang;
        if (last < 0 && now >= 0) {
            const double time = bodies.time() - dt * now / (now - last);
            if (++found == 0) first = time;
            if (found == swings) return (time - first) / swings;
        }
        last = now;
    }
    return 0;
}

std::array<double, 6> sum(const std::array<double, 6>& a, std::span<const double> load, double factor, const Vec3& at) {
    auto out = a;
    const Vec3 force{load[0], load[1], load[2]}, moment = cross(at, force);
    for (std::size_t k = 0; k < 3; ++k) {
        out[k] += factor * load[k];
        out[3 + k] += factor * (load[3 + k] + moment[k]);
    }
    return out;
}

} // namespace

TEST(Joint, APendulumHasThePeriodOfItsInertiaAndItsPointStays) {
    using scene::JointKind;
    for (const auto& [kind, dimensions] :
        {std::pair(JointKind::hinge, 3), {JointKind::ball, 3}, {JointKind::hinge, 2}}) {
        const auto setup = pendulum(kind, 0.05, dimensions);
        RigidBodies bodies(setup);
        const double expected = 2 * pi / pulsation(setup, dimensions == 3 ? 1 : 2);
        // The amplitude adds 1/16 of its square, 0.02 %; the step (w dt)^2 / 24; so a tenth of the 1 % of the
        // claim.
        EXPECT_NEAR(period_of(bodies, 0, 5), expected, 1e-3 * expected);
        // Closed to 1e-12 spacings in every step.
        EXPECT_LT(bodies.constraint_error(), 1e-9 * 0.4);
    }
}

TEST(Joint, ASwingWithoutFrictionKeepsItsEnergyOverHundredSwings) {
    const auto setup = pendulum(scene::JointKind::hinge, 1.5);
    RigidBodies bodies(setup);
    const double start = bodies.energy()[1], deepest = setup.joints[0].point[2] - 0.2;
    double lowest = start, highest = -1e300, late = -1e300;
    const double swing = setup.bodies[0].mass * gravity * (setup.bodies[0].centre[2] - deepest);
    for (int k = 0; k < 120000; ++k) {
        run(bodies, dt, 1);
        const auto energy = bodies.energy();
        lowest = std::min(lowest, energy[0] + energy[1]);
        highest = std::max(highest, energy[0] + energy[1]);
        if (k > 118000) late = std::max(late, energy[1]);
    }
    // Symplectic of first order: the energy oscillates with w dt, 0.7 %, and does not drift.
    EXPECT_GT(lowest, start - 0.02 * swing);
    EXPECT_LT(highest, start + 0.02 * swing);
    EXPECT_NEAR(late, start, 0.01 * swing) << "as high as at the start, after two minutes";
}

TEST(Joint, AHingeTurnsAboutItsAxisAloneAndCarriesTheWeight) {
    auto setup = pendulum(scene::JointKind::hinge, 0);
    RigidBodies bodies(setup);
    run(bodies, dt, 1);
    const std::vector<double> sideways{0, 3, 0, 0, 0, 2}; // along the axis, and a twist out of the plane
    for (int k = 0; k < 200; ++k) {
        bodies.begin(dt);
        bodies.fall(dt);
        bodies.push(sideways, dt);
        bodies.move(dt);
    }
    EXPECT_LT(length(bodies.velocity(0)), 1e-9);
    EXPECT_LT(length(rotation_vector(bodies.pose(0).turn)), 1e-9);
    const auto loads = bodies.joint_loads();
    EXPECT_NEAR(loads[2], setup.bodies[0].mass * gravity, 1e-6);
    EXPECT_NEAR(loads[1], -3, 1e-6);
    EXPECT_NEAR(loads[5], -2, 1e-6);
    EXPECT_NEAR(loads[3], 0, 1e-6) << "about the centre: the pull at the hinge and its torque are a pair";
}

TEST(Joint, TwoBodiesLinkedByABallFallFreelyWithTheirMomentum) {
    auto left = make_body(box({0, 0, 0}, {0.4, 0.1, 0.1})), right = make_body(box({0.4, 0, 0}, {0.6, 0.1, 0.1}));
    left.angular_velocity = {2, -3, 5};
    right.velocity = {0.5, 1, -1};
    auto setup = world({left, right});
    setup.joints = {joint_of(scene::JointKind::ball, 0, 1, {0.4, 0.05, 0.05})};
    RigidBodies bodies(setup);
    const auto before = bodies.momentum();
    double scale = 0, gap = 0;
    for (const double p : before) scale = std::max(scale, std::abs(p));
    for (int k = 0; k < 2000; ++k) {
        run(bodies, dt, 1);
        gap = std::max(gap, bodies.constraint_error());
    }
    const auto after = bodies.momentum();
    // Round-off of 2000 steps in sums of this size; the angular momentum has a lever arm of two metres by
    // then.
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(after[k], before[k], 1e-12 * scale);
    EXPECT_LT(gap, 1e-9 * 0.4);
    EXPECT_GT(length(bodies.spin(1)), 0.1) << "the one drags the other along";

    setup.gravity = {0, 0, -gravity};
    RigidBodies falling(setup);
    run(falling, dt, 500);
    EXPECT_NEAR(falling.momentum()[2], before[2] - (left.mass + right.mass) * gravity * 0.5, 1e-11 * scale);
}

TEST(Joint, ASliderMovesAlongItsAxisWithoutTurning) {
    auto setup = world({make_body(box({0, 0, 0}, {0.2, 0.3, 0.4}))});
    setup.gravity = {0, 0, -gravity};
    setup.joints = {joint_of(scene::JointKind::slider, 0, -1, {0.3, 0.3, 0.3}, {0.6, 0, 0.8})};
    RigidBodies bodies(setup);
    run(bodies, dt, 500);
    const Vec3 way = bodies.pose(0).centre - setup.bodies[0].centre;
    const double fallen = 0.5 * gravity * 0.8 * 0.5 * 0.501; // symplectic Euler is late by half a step
    EXPECT_NEAR(length(way + fallen * setup.joints[0].axis), 0, 1e-9);
    EXPECT_LT(length(rotation_vector(bodies.pose(0).turn)), 1e-12);
}

TEST(Joint, AFourBarLinkageThatIsHeldTwiceMovesAndStaysClosed) {
    // A crank, a coupler and a rocker between hinges with parallel axes: in space each loop is held more than
    // once.
    auto crank = make_body(box({-0.01, -0.01, -0.01}, {0.11, 0.01, 0.01}));
    auto coupler = make_body(box({0.1, -0.01, -0.01}, {0.4, 0.01, 0.01}));
    auto rocker = make_body(box({0.39, -0.21, -0.01}, {0.41, 0.01, 0.01}));
    auto setup = world({crank, coupler, rocker});
    using scene::JointKind;
    setup.joints = {joint_of(JointKind::hinge, 0, -1, {0, 0, 0}), joint_of(JointKind::hinge, 1, 0, {0.1, 0, 0}),
        joint_of(JointKind::hinge, 2, 1, {0.4, 0, 0}), joint_of(JointKind::hinge, 2, -1, {0.4, -0.2, 0})};
    RigidBodies bodies(setup);
    double gap = 0, turned = 0;
    for (int k = 0; k < 2000; ++k) {
        bodies.begin(dt);
        std::vector<double> loads(18, 0.0);
        loads[5] = k < 500 ? 1e-3 : 0;
        bodies.push(loads, dt);
        bodies.move(dt);
        gap = std::max(gap, bodies.constraint_error());
        turned = std::max(turned, length(rotation_vector(bodies.pose(2).turn)));
    }
    EXPECT_LT(gap, 1e-6 * 0.4);
    EXPECT_GT(turned, 0.1) << "the rocker follows";
}

TEST(Joint, AHingeOnAKinematicBodyIsCarriedAlong) {
    auto cart = make_body(box({-0.1, -0.1, 0}, {0.1, 0.1, 0.1}));
    cart.kind = scene::BodyKind::kinematic;
    cart.velocity = {0.5, 0, 0};
    auto bob = make_body(box({-0.02, -0.02, -0.3}, {0.02, 0.02, 0}));
    auto setup = world({cart, bob});
    setup.gravity = {0, 0, -gravity};
    setup.joints = {joint_of(scene::JointKind::hinge, 1, 0, {0, 0, 0}, {0, 1, 0})};
    RigidBodies bodies(setup);
    run(bodies, dt, 1000);
    EXPECT_LT(bodies.constraint_error(), 1e-12);
    EXPECT_NEAR(bodies.pose(0).centre[0], 0.5, 1e-12);
    EXPECT_NEAR(bodies.pose(1).centre[0], 0.5, 0.16) << "it swings below the cart";
    const auto loads = bodies.joint_loads();
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(loads[k], -loads[6 + k], 1e-9) << "equal and opposite";
}

TEST(Joint, JointsThatContradictEachOtherEndTheRun) {
    auto left = make_body(box({-0.2, 0, 0}, {-0.1, 0.1, 0.1})), right = make_body(box({0.1, 0, 0}, {0.2, 0.1, 0.1}));
    left.kind = right.kind = scene::BodyKind::kinematic;
    left.velocity = {-1, 0, 0};
    right.velocity = {1, 0, 0};
    auto setup = world({left, make_body(box({-0.1, 0, 0}, {0.1, 0.1, 0.1})), right});
    using scene::JointKind;
    setup.joints = {joint_of(JointKind::ball, 1, 0, {-0.1, 0, 0}), joint_of(JointKind::ball, 1, 2, {0.1, 0, 0})};
    RigidBodies bodies(setup);
    EXPECT_THROW(run(bodies, dt, 10), SimulationError);
}

TEST(Joint, AChainThatLiesOnTheFloorRestsAndItsLoadsAreItsWeight) {
    std::vector<BodySetup> links;
    for (int k = 0; k < 3; ++k) {
        links.push_back(make_body(box({0.2 * k, 0, 0}, {0.2 * k + 0.2, 0.1, 0.1})));
        links.back().friction = 0.5;
    }
    auto setup = on_floor(links);
    using scene::JointKind;
    setup.joints = {
        joint_of(JointKind::ball, 0, 1, {0.2, 0.05, 0.05}), joint_of(JointKind::hinge, 1, 2, {0.4, 0.05, 0.05})};
    RigidBodies bodies(setup);
    run(bodies, dt, 1000);
    double weight = 0, carried = 0;
    for (std::size_t b = 0; b < 3; ++b) {
        EXPECT_LT(length(bodies.velocity(b)), 1e-6);
        weight += setup.bodies[b].mass * gravity;
        carried += bodies.contact_loads()[6 * b + 2];
    }
    EXPECT_NEAR(carried, weight, 1e-6 * weight);
}

TEST(Joint, AWheelThatIsPinnedDoesNotGiveWayToASolidThatPressesOnIt) {
    // The contact points at the hinge: no impulse can move the wheel, and none may grow without bound.
    auto wheel = make_body(ball({0, 0, 0.5}, 0.1));
    auto brick = make_body(box({-0.05, -0.05, 0.6}, {0.05, 0.05, 0.7}));
    auto setup = world({wheel, brick});
    setup.bodies[1].locked = {true, true, false, true, true, true};
    setup.gravity = {0, 0, -gravity};
    setup.joints = {joint_of(scene::JointKind::hinge, 0, -1, {0, 0, 0.5}, {0, 1, 0})};
    RigidBodies bodies(setup);
    run(bodies, dt, 500);
    EXPECT_NEAR(bodies.pose(1).centre[2], 0.65, 0.02 * 0.05) << "lies on the wheel";
    const double weight = brick.mass * gravity;
    EXPECT_NEAR(bodies.contact_loads()[8], weight, 1e-6 * weight);
    EXPECT_NEAR(bodies.contact_loads()[2], -weight, 1e-6 * weight);
    EXPECT_NEAR(bodies.joint_loads()[2], weight + wheel.mass * gravity, 1e-6 * weight);
}

TEST(Loads, OfGravityContactsJointsAndLocksAddUpToTheChangeOfMomentum) {
    // A hinged arm that hits a block, which may only slide.
    auto arm = make_body(box({0, 0, 0.3}, {0.5, 0.1, 0.4}));
    auto block = make_body(box({0.3, 0, 0}, {0.5, 0.1, 0.15}));
    arm.friction = block.friction = 0.4;
    block.locked = {false, true, false, true, false, true};
    auto setup = on_floor({arm, block});
    setup.joints = {joint_of(scene::JointKind::hinge, 0, -1, {0, 0.05, 0.35}, {0, 1, 0})};
    RigidBodies bodies(setup);
    double met = 0;
    for (int k = 0; k < 600; ++k) {
        auto expected = bodies.momentum();
        std::vector<Vec3> centres{bodies.pose(0).centre, bodies.pose(1).centre};
        run(bodies, dt, 1);
        for (std::size_t b = 0; b < 2; ++b) {
            const std::vector<double> weight{0, 0, -setup.bodies[b].mass * gravity, 0, 0, 0};
            expected = sum(expected, weight, dt, centres[b]);
            expected = sum(expected, bodies.contact_loads().subspan(6 * b, 6), dt, centres[b]);
            expected = sum(expected, bodies.joint_loads().subspan(6 * b, 6), dt, centres[b]);
        }
        const auto now = bodies.momentum();
        // Linear momentum, and the angular one about y: those about locked axes are not part of momentum().
        for (const std::size_t j : {0, 1, 2}) ASSERT_NEAR(now[j], expected[j], 1e-10) << j << " in step " << k;
        met = std::max(met, std::abs(bodies.contact_loads()[0]));
    }
    EXPECT_GT(met, 1) << "they did meet";
}

TEST(ConstrainedInverseMass, IsSymmetricPositiveAndAnswersNothingAlongItsConditions) {
    auto left = make_body(box({0, 0, 0}, {0.4, 0.1, 0.1})), right = make_body(box({0.4, 0, 0}, {0.6, 0.1, 0.3}));
    left.locked = {false, true, false, false, false, false};
    auto setup = world({left, right});
    using scene::JointKind;
    setup.joints = {joint_of(JointKind::ball, 0, 1, {0.4, 0.05, 0.05}),
        joint_of(JointKind::hinge, 1, -1, {0.6, 0.05, 0.05}, {0, 0.6, 0.8})};
    const RigidBodies bodies(setup);
    const auto mobility = bodies.mobility();
    std::vector<std::vector<double>> columns;
    for (std::size_t k = 0; k < 12; ++k) {
        std::vector<double> unit(12, 0.0);
        unit[k] = 1;
        columns.push_back(mobility.respond(unit));
    }
    double most = 0;
    for (std::size_t k = 0; k < 12; ++k) most = std::max(most, columns[k][k]);
    EXPECT_GT(most, 0);
    for (std::size_t i = 0; i < 12; ++i) {
        EXPECT_GE(columns[i][i], -1e-14 * most);
        for (std::size_t j = 0; j < 12; ++j) {
            EXPECT_NEAR(columns[i][j], columns[j][i], 1e-13 * most);
            EXPECT_LE(std::abs(columns[i][j]), std::sqrt(std::max(0.0, columns[i][i] * columns[j][j])) + 1e-13 * most);
        }
    }
    // Their response leaves the ball and the hinge closed.
    for (const auto& v : columns) {
        const Vec3 va{v[0], v[1], v[2]}, wa{v[3], v[4], v[5]}, vb{v[6], v[7], v[8]}, wb{v[9], v[10], v[11]};
        const Vec3 ball{0.4, 0.05, 0.05}, pin{0.6, 0.05, 0.05};
        const auto a = setup.bodies[0].centre, b = setup.bodies[1].centre;
        EXPECT_LT(length(va + cross(wa, ball - a) - vb - cross(wb, ball - b)), 1e-12 * most);
        EXPECT_LT(length(vb + cross(wb, pin - b)), 1e-12 * most);
        EXPECT_LT(length(cross(wb, {0, 0.6, 0.8})), 1e-12 * most);
        EXPECT_EQ(va[1], 0) << "locked";
    }
    EXPECT_TRUE(mobility.can_move(0));
}

TEST(ConstrainedInverseMass, KnowsABodyThatCannotMove) {
    auto setup = world({make_body(box({0, 0, 0}, {0.4, 0.1, 0.1})), make_body(box({1, 0, 0}, {1.4, 0.1, 0.1}))});
    using scene::JointKind;
    setup.joints = {joint_of(JointKind::ball, 0, -1, {0, 0, 0}), joint_of(JointKind::ball, 0, -1, {0.4, 0, 0})};
    EXPECT_TRUE(RigidBodies(setup).mobility().can_move(0)) << "about the line through both";
    setup.joints.push_back(joint_of(JointKind::ball, 0, -1, {0, 0.1, 0}));
    EXPECT_FALSE(RigidBodies(setup).mobility().can_move(0));
    EXPECT_TRUE(RigidBodies(setup).mobility().can_move(1));
    setup.bodies[1].locked.fill(true);
    EXPECT_FALSE(RigidBodies(setup).mobility().can_move(1));
}

TEST(Joint, ARestoredStateGoesOnBitForBit) {
    const auto setup = pendulum(scene::JointKind::ball, 0.7);
    RigidBodies straight(setup);
    run(straight, dt, 300);
    RigidBodies resumed(setup);
    resumed.restore(straight.state());
    run(straight, dt, 300);
    run(resumed, dt, 300);
    EXPECT_EQ(straight.state(), resumed.state());
    EXPECT_TRUE(std::ranges::equal(straight.joint_loads(), resumed.joint_loads()));
}

} // namespace treacle::rigid::joint_test
