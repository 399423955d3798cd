#include "grid/geometry/seeding.hpp"
#include "grid/transport/inflow.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

namespace treacle::grid::density_relaxation_test {
namespace {

class Contracting : public testing::Test {
protected:
    const Comm comm = Comm::world();

    // In a plane tank of walls, 1 m wide.
    static StepSample tank(double viscosity) {
        auto sample = sample_of(16, 2);
        sample.setup.viscosity = viscosity;
        sample.liquid = [](const Vec3&) { return 1.0; };
        return sample;
    }
    // Filled up to 0.6 m; each fifth particle is missing, wherever it is.
    static StepSample sparse_tank(double viscosity) {
        auto sample = tank(viscosity);
        sample.liquid = [](const Vec3& x) {
            const auto number = std::llround(1e6 * (x[0] + 31 * x[1]));
            return scatter(number) > 0.6 ? 1.0 : x[1] - 0.6;
        };
        return sample;
    }
    // Twice the height of the centre of mass [m].
    static double level(const GridStep& step) {
        const auto totals = step.totals();
        return 2 * totals.potential_energy / (9.81 * totals.mass);
    }
    static double volume(const GridStep& step) { return step.totals().mass / 1000; } // [m2]

    std::unique_ptr<GridStep> after(const StepSample& sample, double end, double longest) const {
        auto step = started(comm, sample);
        for (double time = 0; time < end;) {
            const double dt = std::min(longest, step->stable_step(1));
            step->advance(dt);
            time += dt;
        }
        return step;
    }
};

// Solved for one after the other and together.
TEST_F(Contracting, SparseLiquidTakesItsVolumeAgain) {
    for (const auto solve : {StokesSolve::split, StokesSolve::together}) {
        auto sample = sparse_tank(50);
        sample.setup.options.stokes.solve = solve;
        const auto step = after(sample, 2, 0.01); // steps that count for half of one
        EXPECT_LT(volume(*step), 0.52);           // it began with 0.6
        EXPECT_NEAR(level(*step), volume(*step), 0.04 * volume(*step));
        sample.setup.options.density_relaxation.steps = 0;
        const auto without = after(sample, 0.2, 0.01);
        EXPECT_GT(level(*without), 1.08 * volume(*without)); // or there would be nothing to measure
    }
}

// Height of the centre of mass that sparse liquid has lost after the same time in long and in short steps: by its numbers of steps it would
// be several times as much in the short ones.
TEST_F(Contracting, DoesNotDependOnTheNumberOfSteps) {
    double lost[2];
    for (std::size_t k = 0; k < 2; ++k) {
        auto sample = sparse_tank(2000);
        const double first = level(*after(sample, 0, 1));
        lost[k] = first - level(*after(sample, 0.32, k == 0 ? 0.016 : 0.002));
    }
    EXPECT_GT(lost[0], 0.01);
    EXPECT_NEAR(lost[1], lost[0], 0.25 * lost[0]);
}

// A jet that falls by 13 cells is thinner than two of them below.
TEST_F(Contracting, WhatIsPouredFromHighHasItsVolume) {
    for (const double viscosity : {5.0, 50.0}) {
        auto sample = tank(viscosity);
        auto& inflow = sample.setup.inflow;
        flow::InletSetup inlet;
        inlet.centre = {0.3, 0.82, 0};
        inlet.direction = {0, -1, 0};
        inlet.along = {1, 0, 0};
        inlet.speed = 1;
        inlet.end = 3;
        const double spacing = sample.setup.domain.spacing / particles_per_axis;
        for (int i = 0; i < 6; ++i) inlet.points.push_back({(i - 2.5) * spacing, 0, 0});
        inflow.inlets = {inlet};
        inflow.first_id = 100000;
        sample.setup.rigid.bodies = make_inlet_bodies(inflow, make_mac_grid(sample.setup.domain));
        sample.setup.slip = {{scene::Slip::no_slip}, {0}};
        const auto step = after(sample, 4, 0.02);
        EXPECT_NEAR(level(*step), volume(*step), 0.05 * volume(*step)) << viscosity;
    }
}

// A tank of 0.6 m without the particles of a cube at a place and of a size [cells]. Returns the most kinetic energy of some steps over
// what a vacuum there has: pressure times volume.
double fall_into_a_hole(int dimensions, const Vec3& at, double size) {
    constexpr int cells = 12;
    auto sample = sample_of(cells, dimensions);
    const auto up = static_cast<std::size_t>(dimensions - 1);
    sample.liquid = [=](const Vec3& x) {
        bool in_hole = true;
        for (std::size_t k = 0; k <= up; ++k) in_hole = in_hole && x[k] * cells > at[k] && x[k] * cells < at[k] + size;
        return in_hole ? 1.0 : x[up] - 0.6;
    };
    const auto step = started(Comm::world(), sample);
    double most = 0;
    for (int k = 0; k < 6; ++k) {
        step->advance(0.02);
        most = std::max(most, step->totals().kinetic_energy);
    }
    return most / (1000 * 9.81 * 0.55 * std::pow(size / cells, dimensions));
}

TEST(Pores, LetNoLiquidFallIntoThem) {
    for (const int dimensions : {2, 3}) {
        for (const auto& at : {Vec3{0, 0, 0}, Vec3{5, 0, 0}, Vec3{5, 4, 0}, Vec3{11, 0, 0}, Vec3{4.25, 3.25, 3.25}}) {
            EXPECT_LT(fall_into_a_hole(dimensions, at, 1), 0.03)
                << dimensions << " at " << at[0] << ' ' << at[1] << ' ' << at[2]; // 0.1 to 0.8 if it were air
        }
        EXPECT_GT(fall_into_a_hole(dimensions, {0, 0, 0}, 4), 0.2); // air
    }
}

} // namespace
} // namespace treacle::grid::density_relaxation_test
