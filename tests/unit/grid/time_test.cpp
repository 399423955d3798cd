#include "solve/rows/runtime.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

// The step in time: what moves as one does so whatever the length of the steps and whatever else moves.
namespace treacle::grid {
namespace {

constexpr double radius = 0.1, spin = 3;

// A ball of liquid, a disc in the plane, that turns about z and flies, in open space.
StepSample ball(int dimensions, int cells, double viscosity, const Vec3& flight) {
    auto sample = sample_of(cells, dimensions);
    auto& domain = sample.setup.domain;
    domain.spacing = radius / cells;
    domain.min = {-0.3, -0.3, -0.3};
    domain.max = {0.3, 0.3, 0.3};
    for (std::size_t k = 0; k < 3; ++k) domain.max[k] += std::ceil(1.2 * std::max(flight[k], 0.0) / 0.1) * 0.1;
    domain.gravity = {0, 0, 0};
    sample.setup.rigid.gravity = {0, 0, 0};
    sample.setup.viscosity = viscosity;
    sample.jitter = 0;
    sample.liquid = [=](const Vec3& x) { return std::hypot(x[0], x[1], dimensions == 3 ? x[2] : 0.0) - radius; };
    sample.velocity = [=](const Vec3& x) { return Vec3{flight[0] - spin * x[1], flight[1] + spin * x[0], flight[2]}; };
    sample.gradient = {{{0, -spin, 0}, {spin, 0, 0}, {0, 0, 0}}};
    return sample;
}

struct Motion {
    Vec3 centre{}, momentum{}, about_centre{};
    double mass = 0, energy = 0, size = 0;
    int steps = 0;
};

Motion motion_of(const GridStep& step) {
    Motion out;
    const auto totals = step.totals();
    const auto& p = step.particles();
    double sums[5] = {};
    for (int i = 0; i < p.store.owned(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            sums[k] += p.position()(i, k);
            sums[3] += p.position()(i, k) * p.position()(i, k);
        }
        ++sums[4];
    }
    step.comm().sum(std::span<double>(sums));
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        out.centre[k] = sums[k] / sums[4];
        square += out.centre[k] * out.centre[k];
    }
    out.size = std::sqrt(sums[3] / sums[4] - square);
    out.mass = totals.mass;
    out.energy = totals.kinetic_energy;
    out.momentum = totals.momentum;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
        out.about_centre[k] =
            totals.angular_momentum[k] - out.centre[a] * out.momentum[b] + out.centre[b] * out.momentum[a];
    }
    return out;
}

Motion run(const StepSample& sample, double end, double cfl) {
    auto step = started(Comm::world(), sample);
    double time = 0;
    int steps = 0;
    while (time < end * (1 - 1e-9)) {
        const double limit = step->stable_step(cfl), left = end - time;
        time += step->advance(left / std::max(1.0, std::ceil(left / limit))).dt;
        ++steps;
    }
    step->refresh();
    auto out = motion_of(*step);
    out.steps = steps;
    return out;
}

struct SolverEnvironment : ::testing::Environment {
    void SetUp() override { runtime_ = std::make_unique<solve::SolveRuntime>(); }
    void TearDown() override { runtime_.reset(); }
    std::unique_ptr<solve::SolveRuntime> runtime_;
};
[[maybe_unused]] const auto* const solver_environment = testing::AddGlobalTestEnvironment(new SolverEnvironment);

// Default steps of three cells, in which the ball turns by 0.3 rad: 3 rad in all.
TEST(StepInTime, KeepsTheSpinOfABallOfAnyViscosity) {
    for (const double viscosity : {0.0, 1.0, 100.0, 1e5}) {
        const auto sample = ball(3, 10, viscosity, {0, 0, 0});
        const auto start = motion_of(*started(Comm::world(), sample)), end = run(sample, 1, 3);
        EXPECT_NEAR(end.about_centre[2] / start.about_centre[2], 1, 0.02) << viscosity;
        if (viscosity < 100) continue;
        EXPECT_NEAR(end.size / start.size, 1, 0.01) << viscosity; // neither spirals out nor shrinks
    }
}

// Particles traced through velocities that are frozen in space would drift sideways by w x U dt / 2 of the time.
TEST(StepInTime, IsTheSameForABallThatFlies) {
    for (const int dimensions : {2, 3}) {
        const auto rest = run(ball(dimensions, dimensions == 2 ? 10 : 8, 100, {0, 0, 0}), 1, 3);
        for (const Vec3& flight : {Vec3{1.3, 0, 0}, Vec3{0.35, 0.69, 1.04}}) {
            if (dimensions == 3 && flight[2] == 0) continue;
            const Vec3 u{flight[0], flight[1], dimensions == 3 ? flight[2] : 0};
            const auto end = run(ball(dimensions, dimensions == 2 ? 10 : 8, 100, u), 1, 3);
            double off = 0;
            for (std::size_t k = 0; k < 3; ++k) off = std::hypot(off, end.centre[k] - rest.centre[k] - u[k]);
            EXPECT_LT(off, 1e-3);
            EXPECT_NEAR(end.about_centre[2] / rest.about_centre[2], 1, 0.01);
            EXPECT_NEAR(end.size / rest.size, 1, 0.01);
        }
    }
}

TEST(StepInTime, FallsByHalfOfGravityTimesTimeSquared) {
    for (const double viscosity : {0.0, 1.0, 1e5}) {
        auto sample = ball(2, 4, viscosity, {0, 0, 0});
        sample.setup.domain.gravity = {0, -9.81, 0};
        sample.setup.domain.min[1] = -2;
        sample.velocity = [](const Vec3&) { return Vec3{0.5, 0, 0}; };
        sample.gradient = {};
        const auto start = motion_of(*started(Comm::world(), sample)), end = run(sample, 0.35, 3);
        const double fall = 0.5 * 9.81 * 0.35 * 0.35;
        EXPECT_NEAR(start.centre[1] - end.centre[1], fall, 1e-4 * fall);
        EXPECT_NEAR(end.centre[0] - start.centre[0], 0.5 * 0.35, 1e-5);
        EXPECT_NEAR(end.momentum[1], -9.81 * 0.35 * end.mass, 1e-4 * end.mass); // of the end of the step
        EXPECT_NEAR(end.energy, 0.5 * end.mass * (0.25 + std::pow(9.81 * 0.35, 2)), 1e-3 * end.energy);
    }
}

// Water that collapses between walls, in steps of three cells.
TEST(StepInTime, GivesACollapsingColumnHardlyAnyEnergy) {
    auto sample = sample_of(50, 2);
    sample.setup.domain.max = {3.6, 0.6, 0};
    sample.setup.viscosity = 1e-3;
    sample.jitter = 0;
    sample.liquid = [](const Vec3& x) { return std::max(x[0] - 0.6, x[1] - 0.3); };
    auto step = started(Comm::world(), sample);
    const auto energy = [&] {
        const auto totals = step->totals();
        return totals.kinetic_energy + totals.potential_energy;
    };
    const double first = energy();
    double time = 0, most = first;
    while (time < 1.5) {
        time += step->advance(step->stable_step(3)).dt;
        most = std::max(most, energy());
    }
    // Measured 1.000 to 1.013 by where the particles start; what falls meets the floor in cells that no step resolves.
    EXPECT_LT(most, 1.02 * first);
}

// Water at rest, at the longest steps that are allowed: waves two cells long turn by more than two radians in a step of three cells'
// fall, and grew until they broke, at half a metre a second for ever.
TEST(StepInTime, LeavesATankAtRest) {
    for (const double viscosity : {0.0, 1e-3, 0.1, 5.0}) {
        auto sample = sample_of(32, 2);
        sample.setup.viscosity = viscosity;
        sample.liquid = [](const Vec3& x) { return x[1] - 0.4; };
        const auto step = started(Comm::world(), sample);
        const auto first = step->totals();
        double most = first.kinetic_energy + first.potential_energy, time = 0;
        while (time < 4) {
            const double dt = step->stable_step(sample.setup.options.cfl);
            step->advance(dt);
            const auto now = step->totals();
            most = std::max(most, now.kinetic_energy + now.potential_energy);
            time += dt;
        }
        RecordProperty("speed_" + std::to_string(viscosity), std::to_string(step->totals().max_speed));
        EXPECT_LT(step->totals().max_speed, 0.05) << viscosity;
        EXPECT_LT(most, 1.001 * first.potential_energy) << viscosity;
    }
}

} // namespace
} // namespace treacle::grid
