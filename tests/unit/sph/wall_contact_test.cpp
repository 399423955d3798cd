#include "parts.hpp"
#include "sph/forces/wall_contact.hpp"

namespace treacle::sph::wall_contact_test {
namespace {

constexpr double dt = 4e-3;             // [s]
constexpr double depth = 0.5 * spacing; // of the layers below their surfaces [m]

// A particle in front of a floor, and on request of a wall at x = 0, both of body 1.
struct Approach {
    Vec3 x;
    Vec3 u;
    bool corner = false;
};
struct Outcome {
    Vec3 u;
    Vec3 mean; // place at the end [m]
    BodyLoads loads;
    std::int64_t stopped;
    double mass;
};

Outcome meet(const Approach& approach) {
    Sample sample{make_setup(make_domain(3, {-1, -1, -1}, {1, 1, 1})), {}, {}};
    sample.setup.constants.wall_depth = depth;
    sample.liquid.push_back({approach.x, approach.u});
    for (int j = -6; j <= 6; ++j) {
        for (int i = -6; i <= 6; ++i) {
            sample.solid.push_back({{i * spacing, j * spacing, -depth}, 1, {0, 0, 1}});
            if (approach.corner) sample.solid.push_back({{-depth, j * spacing, i * spacing}, 1, {1, 0, 0}});
        }
    }
    Parts parts(Comm::self(), sample);
    Outcome out{{}, {}, BodyLoads(12, 0.0), 0, parts.setup.constants.mass};
    out.stopped = stop_at_walls(parts.step(), {MomentReferencePoints(2), dt}, out.loads);
    const auto u = test::on_host(parts.liquid.velocity());
    for (std::size_t k = 0; k < 3; ++k) {
        out.u[k] = u(0, k);
        out.mean[k] = approach.x[k] + dt * u(0, k);
    }
    return out;
}

constexpr double rounding = 1e-13;
} // namespace

TEST(WallContact, AParticleThatWouldSinkBelowTheSurfaceEndsTheStepOnIt) {
    const auto end = meet({{0, 0, 0.9 * spacing}, {1, -2, -40}});
    EXPECT_EQ(end.stopped, 1);
    EXPECT_NEAR(end.mean[2], 0, rounding);
    EXPECT_EQ(end.u[0], 1) << "it slides";
    EXPECT_EQ(end.u[1], -2);
}

TEST(WallContact, AParticleThatStaysAboveIsLeftAlone) {
    const auto end = meet({{0, 0, 0.9 * spacing}, {1, -2, -0.8 * spacing / dt}});
    EXPECT_EQ(end.stopped, 0);
    EXPECT_EQ(end.u[2], -0.8 * spacing / dt);
    EXPECT_EQ(end.loads, BodyLoads(12, 0.0));
}

TEST(WallContact, BelowTheSurfaceItSinksNoFurtherAndMayRise) {
    EXPECT_EQ(meet({{0, 0, -0.2 * spacing}, {0, 0, -1}}).u[2], 0);
    EXPECT_EQ(meet({{0, 0, -0.2 * spacing}, {0, 0, 1}}).u[2], 1);
}

TEST(WallContact, InACornerBothWallsHold) {
    const auto end = meet({{0.4 * spacing, 0, 0.6 * spacing}, {-30, 3, -30}, true});
    EXPECT_EQ(end.stopped, 1) << "one particle, whatever walls";
    EXPECT_GE(end.mean[0], -rounding);
    EXPECT_GE(end.mean[2], -rounding);
    EXPECT_EQ(end.u[1], 3);
}

TEST(WallContact, TheSolidGetsTheMomentumAndTheAngularMomentum) {
    const Approach approach{{0.3 * spacing, 0.2 * spacing, 0.7 * spacing}, {1, -2, -40}};
    const auto end = meet(approach);
    Vec3 change;
    for (std::size_t k = 0; k < 3; ++k) change[k] = end.mass * (end.u[k] - approach.u[k]);
    const double scale = end.mass * 40;
    ASSERT_GT(change[2], 0.1 * scale);
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
        const double turn = approach.x[l] * change[m] - approach.x[m] * change[l];
        EXPECT_NEAR(end.loads[6 + k] * dt, -change[k], rounding * scale);
        EXPECT_NEAR(end.loads[9 + k] * dt, -turn, rounding * scale);
        EXPECT_EQ(end.loads[k], 0) << "of the other body";
    }
}

} // namespace treacle::sph::wall_contact_test
