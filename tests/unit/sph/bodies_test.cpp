#include "../total_momentum.hpp"
#include "parts.hpp"
#include "sph/pressure/rigid_coupling_term.hpp"

#include <functional>

namespace treacle::sph::bodies_test {
namespace {

constexpr double dt = 2e-3; // [s]

SphOptions tight() {
    SphOptions options;
    options.pressure.solver = PressureSolver::isph;
    options.pressure.stop = StoppingRule::residual;
    options.pressure.residual = 1e-13;
    return options;
}

// A brick of 3 x 3 x 5 spacings, as solid number 1, inside a block of liquid in free space.
Sample brick_in_liquid(const Vec3& velocity, double density_ratio) {
    auto sample = Sample{make_setup(make_domain(3, {0, 0, 0}, {24 * spacing, 12 * spacing, 12 * spacing},
                                        {scene::BoundaryKind::open, {false, false, false}}),
                             tight()),
        {}, {}};
    add_block(sample, {{2.5 * spacing, 2.5 * spacing, 2.5 * spacing}, {19, 7, 7}, spacing, 0.05});
    const Vec3 lo{6 * spacing, 4 * spacing, 3.5 * spacing};
    std::erase_if(sample.liquid, [&](const auto& point) {
        const double margin = 0.9 * spacing;
        return point.x[0] > lo[0] - margin && point.x[0] < lo[0] + 2 * spacing + margin &&
               point.x[1] > lo[1] - margin && point.x[1] < lo[1] + 2 * spacing + margin &&
               point.x[2] > lo[2] - margin && point.x[2] < lo[2] + 4 * spacing + margin;
    });
    add_shell(sample, lo, {3, 3, 5}, 1);
    rigid::BodySetup brick;
    brick.kind = scene::BodyKind::dynamic;
    const Vec3 edge{3 * spacing, 3 * spacing, 5 * spacing};
    brick.mass = density_ratio * rest_density * edge[0] * edge[1] * edge[2];
    for (std::size_t k = 0; k < 3; ++k) {
        const double a = edge[(k + 1) % 3], b = edge[(k + 2) % 3];
        brick.inertia[k][k] = brick.mass / 12 * (a * a + b * b);
        brick.centre[k] = lo[k] + (k == 2 ? 2 : 1) * spacing;
    }
    brick.velocity = velocity;
    brick.angular_velocity = {0.5, -1, 2};
    brick.bounding_radius = 4 * spacing;
    sample.setup.rigid.bodies = {brick};
    sample.setup.rigid.spacing = spacing;
    sample.setup.first_body = 1;
    sample.setup.forces.friction = {0, 1};
    sample.setup.forces.artificial = 0.02;
    sample.setup.forces.viscosity = 0.5;
    return sample;
}

enum class Constraint { by_each_other, by_a_hinge_too };
// Two of them side by side, linked by a ball joint; the second one, solid number 2, may be hinged to the world.
Sample linked_bricks(Constraint constraint) {
    using rigid::operator*;
    using rigid::operator+;
    auto sample = brick_in_liquid({1.5, 0.2, -0.1}, 0.3);
    const Vec3 lo{11 * spacing, 4 * spacing, 3.5 * spacing};
    std::erase_if(sample.liquid, [&](const auto& point) {
        const double margin = 0.9 * spacing;
        return point.x[0] > lo[0] - margin && point.x[0] < lo[0] + 2 * spacing + margin &&
               point.x[1] > lo[1] - margin && point.x[1] < lo[1] + 2 * spacing + margin &&
               point.x[2] > lo[2] - margin && point.x[2] < lo[2] + 4 * spacing + margin;
    });
    add_shell(sample, lo, {3, 3, 5}, 2);
    auto& rigid = sample.setup.rigid;
    auto other = rigid.bodies[0];
    other.centre[0] = lo[0] + spacing;
    other.velocity = {0, 0, 0};
    other.angular_velocity = {0, 0, 0};
    rigid.bodies.push_back(other);
    rigid::JointSetup ball;
    ball.kind = scene::JointKind::ball;
    ball.body = 0;
    ball.other = 1;
    ball.point = 0.5 * (rigid.bodies[0].centre + other.centre);
    rigid.joints = {ball};
    if (constraint == Constraint::by_a_hinge_too) {
        rigid::JointSetup hinge;
        hinge.kind = scene::JointKind::hinge;
        hinge.body = 1;
        hinge.point = other.centre;
        hinge.axis = {0, 0.6, 0.8};
        rigid.joints.push_back(hinge);
    }
    sample.setup.bodies = 3;
    sample.setup.forces.friction = {0, 1, 1};
    return sample;
}

// By the velocities of the middle of the last step, which forces and joints change exactly.
std::array<double, 6> middle_momentum(const IsphStep& step) {
    auto sum = measure_momentum(step.comm(), step.liquid(), step.setup().constants, step.liquid().velocity());
    const auto bodies = step.bodies().free_momenta();
    for (std::size_t b = 0; b < step.bodies().size(); ++b) {
        const double* one = &bodies[rigid::RigidBodies::momentum_numbers * b];
        for (std::size_t k = 0; k < 6; ++k) sum[k] += one[k] + (k < 3 ? 0 : one[3 + k]);
    }
    return sum;
}

} // namespace

TEST(Bodies, KeepTheMomentumOfLiquidAndBodyTogether) {
    for (const double ratio : {0.1, 1.0, 8.0}) {
        const auto sample = brick_in_liquid({1.5, 0.2, -0.1}, ratio);
        const auto step = started(Comm::world(), sample);
        const auto before = total_momentum(*step);
        const double own = step->bodies().momentum()[0];
        for (int k = 0; k < 10; ++k) step->advance(dt);
        const auto after = total_momentum(*step);
        EXPECT_LT(step->bodies().momentum()[0], 0.97 * own) << "the liquid slows it down";
        // Round-off of some thousand pairs in ten steps, over the momentum and its moment at one metre.
        for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(after[k], before[k], 1e-12 * own) << k << " at " << ratio;
    }
}

TEST(Bodies, ThatAreLinkedKeepTheMomentumOfAllTogether) {
    const auto step = started(Comm::world(), linked_bricks(Constraint::by_each_other));
    const auto before = total_momentum(*step);
    for (int k = 0; k < 10; ++k) {
        step->advance(dt);
        EXPECT_LT(step->bodies().constraint_error(), 1e-11 * spacing);
    }
    const auto after = total_momentum(*step);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(after[k], before[k], 1e-12 * std::abs(before[0])) << k;
    EXPECT_GT(step->bodies().velocity(1)[0], 0.05) << "the one pulls the other along";
}

TEST(Bodies, ThatAreHingedGiveTheWorldWhatTheirJointsReport) {
    const auto step = started(Comm::world(), linked_bricks(Constraint::by_a_hinge_too));
    auto expected = middle_momentum(*step);
    const double scale = std::abs(expected[0]);
    double given = 0;
    for (int k = 0; k < 10; ++k) {
        std::vector<Vec3> centres{step->bodies().pose(0).centre, step->bodies().pose(1).centre};
        step->advance(dt);
        for (std::size_t b = 0; b < 2; ++b) { // of the ball joint between them nothing is left
            const double* load = &step->bodies().joint_loads()[6 * b];
            const Vec3 force{load[0], load[1], load[2]}, moment = rigid::cross(centres[b], force);
            for (std::size_t i = 0; i < 3; ++i) {
                expected[i] += dt * load[i];
                expected[3 + i] += dt * (load[3 + i] + moment[i]);
            }
            given += dt * load[0];
        }
    }
    const auto after = middle_momentum(*step);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(after[k], expected[k], 1e-12 * scale) << k;
    EXPECT_GT(std::abs(given), 0.01 * scale) << "the hinge holds something";
    EXPECT_LT(step->bodies().constraint_error(), 1e-11 * spacing);
}

TEST(Bodies, MoveTheSameOnAnyNumberOfRanksAcrossTheirBorders) {
    const auto sample = brick_in_liquid({5, 0, 0}, 2);
    const auto many = started(Comm::world(), sample), one = started(Comm::self(), sample);
    for (int k = 0; k < 40; ++k) {
        many->advance(dt);
        one->advance(dt);
    }
    const auto a = many->bodies().pose(0), b = one->bodies().pose(0);
    EXPECT_GT(b.centre[0] - sample.setup.rigid.bodies[0].centre[0], 4 * spacing) << "over the cuts of the domain";
    // As of a dam break: 1e-13 of the solver, times the growth by chaos.
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(a.centre[k], b.centre[k], 1e-6 * spacing);
    EXPECT_NEAR(rigid::length(rigid::rotation_vector(rigid::product(a.turn, rigid::conjugate(b.turn)))), 0, 1e-6);
    const auto there = all_states(Comm::world(), many->liquid()), here = all_states(Comm::self(), one->liquid());
    ASSERT_EQ(there.size(), here.size());
    for (const auto& [id, state] : here) {
        for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(there.at(id).x[k], state.x[k], 1e-6 * spacing);
    }
}

TEST(Bodies, CarryTheirParticlesWithThem) {
    const auto sample = brick_in_liquid({0.3, 0, 0.1}, 1);
    const auto step = started(Comm::world(), sample);
    for (int k = 0; k < 5; ++k) step->advance(dt);
    const auto& bodies = step->bodies();
    const auto axes = rigid::to_matrix(bodies.pose(0).turn);
    const auto id = test::on_host(step->solid().id());
    const auto x = test::on_host(step->solid().position()), v = test::on_host(step->solid().velocity());
    std::map<std::int64_t, Vec3> at_start;
    for (std::size_t k = 0; k < sample.solid.size(); ++k) at_start[id_of(k)] = sample.solid[k].x;
    using rigid::operator*;
    using rigid::operator+;
    using rigid::operator-;
    for (int s = 0; s < step->solid().store.owned(); ++s) {
        const Vec3 arm = axes * (at_start.at(id(s)) - sample.setup.rigid.bodies[0].centre);
        const Vec3 position = bodies.pose(0).centre + arm;
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(x(s, k), position[std::size_t(k)], 1e-14);
    }
}

namespace {
void expect_symmetric_and_positive(const Sample& sample) {
    const auto product_of = [&](const Comm& comm) {
        Parts parts(comm, sample);
        const auto& setup = parts.setup;
        const Bodies bodies(setup.rigid, {}, setup.first_body, setup.bodies, setup.domain);
        parts.set_by_id(parts.liquid.role(), [](std::int64_t) { return int(Role::poisson); });
        parts.assemble();
        RigidCouplingTerm response;
        response.build(parts.step(), bodies);
        const auto term = response.addition(comm, parts.liquid, parts.system);
        // Vectors that depend on the ids alone.
        const auto id = test::on_host(parts.liquid.id());
        const auto row = test::on_host(parts.liquid.row());
        const auto n = static_cast<std::size_t>(parts.system.rows());
        std::vector<double> p(n), q(n), bp(n, 0.0), bq(n, 0.0);
        for (int i = 0; i < parts.liquid.store.owned(); ++i) {
            const auto r = static_cast<std::size_t>(row(i) - parts.system.first_row());
            p[r] = std::sin(double(id(i)));
            q[r] = std::cos(0.7 * double(id(i)));
        }
        term(p, bp);
        term(q, bq);
        double sums[3] = {0, 0, 0};
        for (std::size_t r = 0; r < n; ++r) {
            sums[0] += q[r] * bp[r];
            sums[1] += p[r] * bq[r];
            sums[2] += p[r] * bp[r];
        }
        comm.sum(std::span<double>(sums));
        return std::array<double, 3>{sums[0], sums[1], sums[2]};
    };
    const auto many = product_of(Comm::world()), one = product_of(Comm::self());
    EXPECT_GT(one[2], 0);
    EXPECT_NEAR(many[0], many[1], 1e-12 * one[2]);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(many[k], one[k], 1e-12 * one[2]);
}
} // namespace

TEST(RigidCouplingTerm, IsSymmetricPositiveAndTheSameOnAnyNumberOfRanks) {
    expect_symmetric_and_positive(brick_in_liquid({0, 0, 0}, 0.5));
}

TEST(RigidCouplingTerm, IsSymmetricPositiveAndTheSameOnAnyNumberOfRanksWithJoints) {
    expect_symmetric_and_positive(linked_bricks(Constraint::by_each_other));
    expect_symmetric_and_positive(linked_bricks(Constraint::by_a_hinge_too));
}

// A ball let go in liquid at rest under gravity: what holds back a light body is the liquid that it moves.
TEST(RigidCouplingTerm, LetsALightBodyRiseWithoutOvershooting) {
    auto sample = brick_in_liquid({0, 0, 0}, 0.1);
    sample.setup.rigid.bodies[0].angular_velocity = {0, 0, 0};
    const double pull = 10;
    sample.setup.forces.gravity = {0, 0, -pull};
    sample.setup.rigid.gravity = {0, 0, -pull};
    const auto step = started(Comm::world(), sample);
    double fastest = 0;
    for (int k = 0; k < 10; ++k) {
        step->advance(dt);
        fastest = std::max(fastest, std::abs(step->bodies().velocity(0)[2]));
    }
    // Liquid in free fall presses on nothing: the body falls with it and no faster.
    EXPECT_LT(fastest, 1.5 * pull * 10 * dt);
}

// A drop at a body, with one neighbour at the rim of its support: the body's response must not count for it many
// times over, or it is thrown off.
TEST(RigidCouplingTerm, CountsForNoParticleMoreThanASourceMay) {
    auto sample = brick_in_liquid({0, 0, 0}, 0.3);
    const double right = 8 * spacing; // of the brick's last layer
    std::erase_if(sample.liquid, [&](const auto& point) { return point.x[0] > 6 * spacing; });
    const double apart = 0.99 * sample.setup.constants.support;
    sample.liquid.push_back({{right + 0.9 * spacing, 5 * spacing, 5.5 * spacing}});
    sample.liquid.push_back({{right + 0.9 * spacing + apart, 5 * spacing, 5.5 * spacing}});
    Parts parts(Comm::world(), sample);
    const double answered = -1000; // [Pa/m2]
    const auto source_with = [&](double value) {
        parts.set_by_id(parts.liquid.response(), [&](std::int64_t) { return value; });
        predict(parts.step(), LastPressures::known, dt, BodyCoupling::strong);
        const auto source = test::on_host(parts.liquid.source());
        return std::vector<double>(source.data(), source.data() + parts.liquid.store.owned());
    };
    const auto without = source_with(0), with = source_with(answered);
    double most = 0;
    for (std::size_t i = 0; i < with.size(); ++i) most = std::max(most, with[i] - without[i]);
    most = parts.comm.max(most);
    const double limit = parts.setup.options.pressure.amplification_limit - 1;
    EXPECT_LE(most, -limit * answered * (1 + 1e-9)) << "round-off of differences of sources";
    EXPECT_GT(most, -0.1 * answered) << "but it counts";
}

TEST(Bodies, KinematicOnesPushLiquidAside) {
    auto sample = brick_in_liquid({0, 0, 0}, 1);
    auto& piston = sample.setup.rigid.bodies[0];
    piston.kind = scene::BodyKind::kinematic;
    piston.velocity = {1, 0, 0};
    piston.angular_velocity = {0, 0, 0};
    const auto step = started(Comm::world(), sample);
    StepReport report;
    for (int k = 0; k < 10; ++k) report = step->advance(dt);
    EXPECT_NEAR(step->bodies().pose(0).centre[0] - piston.centre[0], 10 * dt, 1e-14);
    EXPECT_EQ(step->bodies().velocity(0), (Vec3{1, 0, 0}));
    EXPECT_LT(report.loads[6] + report.viscous_loads[6], 0) << "the liquid resists";
    const auto totals = step->totals();
    EXPECT_GT(totals.momentum[0], 0);
}

} // namespace treacle::sph::bodies_test
