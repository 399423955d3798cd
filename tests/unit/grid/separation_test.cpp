#include "step_sample.hpp"

#include <gtest/gtest.h>

// (L) Liquid under walls from which gravity pulls it.
namespace treacle::grid::separation_test {
namespace {

// Mean velocity along gravity after `time` [s] over g t.
double fallen(StepSample sample, double time) {
    auto step = started(Comm::world(), sample);
    const auto down = static_cast<std::size_t>(sample.setup.domain.dimensions - 1);
    double t = 0;
    while (t < time) t += step->advance(std::min(0.01, step->stable_step(sample.setup.options.cfl))).dt;
    const auto totals = step->totals();
    return -totals.momentum[down] / totals.mass / (9.81 * t);
}

StepSample upper_half(int dimensions, double viscosity) {
    auto sample = sample_of(dimensions == 3 ? 10 : 20, dimensions);
    const auto down = static_cast<std::size_t>(dimensions - 1);
    sample.setup.viscosity = viscosity;
    sample.liquid = [down](const Vec3& x) { return 0.5 - x[down]; };
    return sample;
}

// What is stiff is drawn out from the wall in a step before it is off it.
TEST(Separation, LetsTheUpperHalfOfABoxFall) {
    for (const double viscosity : {0.0, 0.1, 1.0}) {
        EXPECT_NEAR(fallen(upper_half(2, viscosity), 0.2), 1, viscosity < 1 ? 0.01 : 0.03) << viscosity;
    }
}

TEST(Separation, LetsTheUpperHalfOfARoomFall) { EXPECT_NEAR(fallen(upper_half(3, 0), 0.1), 1, 0.02); }

TEST(Separation, LiquidAdheresWhereItIsAskedTo) {
    auto sample = upper_half(2, 0);
    sample.setup.options.pressure.ceilings = Ceilings::adhere;
    EXPECT_LT(fallen(sample, 0.1), 0.02);
}

// No pressure of a full box has a level.
TEST(Separation, FullBoxesStayFull) {
    auto sample = upper_half(2, 0);
    sample.liquid = [](const Vec3&) { return -1.0; };
    EXPECT_LT(std::fabs(fallen(sample, 0.1)), 1e-6);
}

// A slab under a wall that is no side of the domain, through cells at an angle.
TEST(Separation, LetsLiquidFallFromSlopes) {
    for (const double angle : {0.1, 0.3, 0.6}) {
        auto sample = upper_half(2, 0);
        const double s = std::sin(angle), c = std::cos(angle);
        const auto below = [s, c](const Vec3& x) { return -s * (x[0] - 0.5) + c * (x[1] - 0.8); };
        sample.liquid = [below](const Vec3& x) {
            return std::max({below(x), -below(x) - 0.2, std::fabs(x[0] - 0.5) - 0.2});
        };
        rigid::BodySetup body;
        body.kind = scene::BodyKind::fixed;
        scene::Shape plane;
        plane.kind = scene::ShapeKind::plane;
        plane.centre = {0.5, 0.8, 0};
        plane.axis = {s, -c, 0};
        body.region = {scene::SolidRegion(plane)};
        body.bounding_radius = 10;
        sample.setup.rigid.bodies = {body};
        sample.setup.slip = {{scene::Slip::free_slip}, {0}};
        EXPECT_NEAR(fallen(sample, 0.15), 1, 0.05) << angle;
    }
}

} // namespace
} // namespace treacle::grid::separation_test
