#include "parts.hpp"
#include "sph/forces/skin_friction.hpp"

namespace treacle::sph::skin_friction_test {
namespace {

// A particle that slides over a floor of solid particles.
Parts slide(const Vec3& velocity, double coefficient, double dt, BodyLoads& loads) {
    Sample sample{make_setup(make_domain(3, {-1, -1, -1}, {1, 1, 1})), {}, {}};
    sample.liquid.push_back({{0, 0, 0.6 * spacing}, velocity});
    for (int j = -6; j <= 6; ++j) {
        for (int i = -6; i <= 6; ++i) sample.solid.push_back({{i * spacing, j * spacing, -0.6 * spacing}, 1});
    }
    Parts parts(Comm::self(), sample);
    const std::vector<double> coefficients{0, coefficient};
    apply_skin_friction(parts.step(), {coefficients, MomentReferencePoints(2), dt}, loads);
    return parts;
}

double wall_area() {
    const auto setup = make_setup(make_domain(3, {-1, -1, -1}, {1, 1, 1}));
    const CubicSpline<3> kernel(setup.constants.support);
    double volumes = 0, sum = 0;
    for (int j = -6; j <= 6; ++j) {
        for (int i = -6; i <= 6; ++i) {
            const double across = spacing * std::sqrt(double(i * i + j * j));
            const double r = std::hypot(across, 1.2 * spacing);
            if (across < setup.constants.support) volumes += kernel.value(across);
            if (r < setup.constants.support) sum += -kernel.gradient(r) * 1.2 * spacing;
        }
    }
    return sum / volumes;
}
} // namespace

TEST(SkinFriction, SlowsByTheShearStressOnTheWallAreaOfTheParticle) {
    const double dt = 1e-4, speed = 3, coefficient = 0.01;
    BodyLoads loads(12, 0.0);
    auto parts = slide({0, speed, 0}, coefficient, dt, loads);
    const auto u = test::on_host(parts.liquid.velocity());
    const double rate = 0.5 * coefficient * speed * wall_area() * dt;
    EXPECT_NEAR(u(0, 1) / speed, 1 / (1 + rate), 1e-12); // round-off
    EXPECT_LT(u(0, 1), speed * (1 - 1e-5)) << "the floor must be felt";
    EXPECT_NEAR(loads[6 + 1] * dt, parts.setup.constants.mass * (speed - u(0, 1)), 1e-12 * loads[6 + 1] * dt)
        << "the floor gets what the liquid loses";
    EXPECT_EQ(loads[1], 0) << "of the other body";
    EXPECT_NEAR(u(0, 0), 0, 1e-15);
    EXPECT_NEAR(u(0, 2), 0, 1e-12 * speed);
}

TEST(SkinFriction, LeavesTheVelocityTowardsTheWallAlone) {
    BodyLoads loads(12, 0.0);
    auto parts = slide({0, 0, -2}, 0.5, 1e-3, loads);
    EXPECT_NEAR(test::on_host(parts.liquid.velocity())(0, 2), -2, 1e-12);
}

TEST(SkinFriction, NeverReversesHoweverLongTheStep) {
    BodyLoads loads(12, 0.0);
    auto parts = slide({1, 0, 0}, 1, 1e6, loads);
    const double u = test::on_host(parts.liquid.velocity())(0, 0);
    EXPECT_GE(u, 0);
    EXPECT_LT(u, 1e-4);
}

TEST(SkinFriction, OfASmoothWallIsNone) {
    BodyLoads loads(12, 0.0);
    auto parts = slide({1, 0, 0}, 0, 1, loads);
    EXPECT_EQ(test::on_host(parts.liquid.velocity())(0, 0), 1);
}

} // namespace treacle::sph::skin_friction_test
