#include "../sph/solver_environment.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

namespace treacle::grid::walls_test {
namespace {

[[maybe_unused]] const auto* const solvers = testing::AddGlobalTestEnvironment(new sph::SolverEnvironment);

constexpr double g = 9.81, rho = 1000;

class GridWalls : public testing::Test {
protected:
    const Comm comm = Comm::world();
};

// Walls at y = 0 and y = 1 of a liquid that fills all between them, without an end along x.
StepSample channel(int cells, double viscosity) {
    auto sample = sample_of(cells, 2);
    auto& domain = sample.setup.domain;
    domain.max = {0.5, 1, 0};
    domain.gravity = {0, 0, 0};
    for (std::size_t side = 0; side < 2; ++side) domain.faces[side].kind = scene::BoundaryKind::periodic;
    for (std::size_t side = 2; side < 4; ++side) domain.faces[side].slip = scene::Slip::no_slip;
    sample.setup.viscosity = viscosity;
    sample.liquid = [](const Vec3&) { return -1.0; };
    return sample;
}

// Largest error of the particles' velocity along the channel, for a profile that is linear in y.
double error_of(const Comm& comm, const GridStep& step, double at_floor, double slope) {
    double most = 0;
    for (const auto& [id, state] : states(step))
        most = std::max(most, std::fabs(state[3] - at_floor - slope * state[1]));
    return comm.max(most);
}

TEST_F(GridWalls, ASideThatMovesShearsTheLiquidAndIsHeldBack) {
    for (const auto solve : {StokesSolve::split, StokesSolve::together}) {
        for (const double slip : {0.0, 0.25}) {
            auto sample = channel(16, 1e4);
            sample.setup.options.stokes.solve = solve;
            auto& faces = sample.setup.domain.faces;
            faces[3].velocity = {2, 0, 0};
            if (slip > 0) {
                faces[2].slip = scene::Slip::slip_length;
                faces[2].slip_length = slip;
            }
            auto step = started(comm, sample);
            StepReport report;
            for (int k = 0; k < 12; ++k) report = step->advance(0.02); // h^2/nu = 0.1 s
            const double shear = 2 / (1 + slip), drag = 1e4 * shear * 0.5;
            EXPECT_LT(error_of(comm, *step, shear * slip, shear), 0.02) << "slip length " << slip;
            ASSERT_EQ(report.resting_viscous_loads.size(), 36u);
            EXPECT_NEAR(report.resting_viscous_loads[6 * 3], -drag, 0.01 * drag) << "slip length " << slip;
            EXPECT_NEAR(report.resting_viscous_loads[6 * 2], drag, 0.01 * drag) << "slip length " << slip;
            EXPECT_NEAR(report.resting_viscous_loads[6 * 3 + 5], drag, 0.04 * drag) << "its arm is 1 m, to half a cell";
        }
    }
}

TEST_F(GridWalls, ASideThatSlidesAndSlipsTakesTheLiquidAlong) {
    auto sample = channel(16, 1e4);
    auto& top = sample.setup.domain.faces[3];
    top.slip = scene::Slip::slip_length;
    top.slip_length = 0.25;
    top.velocity = {2, 0, 0};
    auto step = started(comm, sample);
    StepReport report;
    for (int k = 0; k < 12; ++k) report = step->advance(0.02);
    EXPECT_LT(error_of(comm, *step, 0, 1.6), 0.02);
    EXPECT_NEAR(report.resting_viscous_loads[6 * 3], -8000, 80);
    EXPECT_NEAR(report.resting_viscous_loads[6 * 2], 8000, 80);
}

// Water, with walls that need not lie between cells.
struct Tank {
    Vec3 max{1, 1, 0};
    double down = -1;   // along y
    double level = 0.5; // depth [m]
    double viscosity = 0;
    scene::Slip slip = scene::Slip::free_slip;
    int settles = 5; // steps: where the walls are off the particles' lattice, the liquid first falls onto them
};

std::vector<Tank> tanks() { return {{}, {{1, 0.975, 0}, 1}, {{0.98, 1, 0}, -1, 0.5, 100, scene::Slip::no_slip, 80}}; }

StepSample sample_of_tank(const Tank& tank, int cells) {
    auto sample = sample_of(cells, 2);
    auto& domain = sample.setup.domain;
    domain.max = tank.max;
    domain.gravity = {0, tank.down * g, 0};
    sample.setup.rigid.gravity = domain.gravity;
    sample.setup.viscosity = tank.viscosity;
    sample.jitter = 0;
    for (auto& face : domain.faces) face.slip = tank.slip;
    const double floor = tank.down < 0 ? 0 : tank.max[1], depth = tank.level, down = tank.down;
    sample.liquid = [=](const Vec3& x) { return -down * (x[1] - floor) - depth; };
    return sample;
}

TEST_F(GridWalls, BearWhatATankHolds) {
    for (const auto& tank : tanks()) {
        auto step = started(comm, sample_of_tank(tank, 20));
        const double weight = step->totals().mass * g;
        std::array<double, 24> mean{};
        constexpr int steps = 10;
        const int calm = tank.settles;
        for (int k = 0; k < calm + steps; ++k) {
            const auto report = step->advance(0.01);
            for (std::size_t i = 0; k >= calm && i < mean.size(); ++i) {
                mean[i] += (report.resting_loads[i] + report.resting_viscous_loads[i]) / steps;
            }
        }
        const std::size_t floor = tank.down < 0 ? 2 : 3, ceiling = 5 - floor;
        const double level = weight / (rho * g * tank.max[0]), push = 0.5 * rho * g * level * level;
        EXPECT_NEAR(mean[6 * floor + 1], tank.down * weight, 0.01 * weight);
        EXPECT_NEAR(mean[6 * ceiling + 1], 0, 0.001 * weight);
        // By the square of the level, which walls that cut cells leave 0.07 cells off.
        const double tolerance = tank.max[1] < 1 ? 0.02 : 0.01;
        EXPECT_NEAR(mean[0], -push, tolerance * push);
        EXPECT_NEAR(mean[6], push, tolerance * push);
        const double height = tank.down < 0 ? level / 3 : tank.max[1] - level / 3;
        EXPECT_NEAR(mean[5], push * height, 0.03 * push * height) << "about the origin";
        EXPECT_NEAR(mean[6 * floor + 5], tank.down * weight * tank.max[0] / 2, 0.02 * weight * tank.max[0] / 2);
    }
}

TEST_F(GridWalls, PressuresGoOnToTheWalls) {
    for (const auto& tank : tanks()) {
        constexpr int cells = 20;
        auto step = started(comm, sample_of_tank(tank, cells));
        for (int k = 0; k < tank.settles; ++k) step->advance(0.01);
        const double level = step->totals().mass / (rho * tank.max[0]), dx = 1.0 / cells;
        const double floor = tank.down < 0 ? 0 : tank.max[1];
        const auto& p = step->particles();
        double worst = 0, lowest = 1;
        std::array<double, 5> sums{}; // of 1, h, p, h h, h p
        for (int i = 0; i < p.store.owned(); ++i) {
            const double height = -tank.down * (p.position()(i, 1) - floor);
            if (height > level - 2 * dx) continue;
            const double found = p.pressure()(i), expected = rho * g * (level - height);
            worst = std::max(worst, std::fabs(found - expected));
            lowest = std::min(lowest, height);
            const double terms[5] = {1, height, found, height * height, height * found};
            for (std::size_t k = 0; k < 5; ++k) sums[k] += terms[k];
        }
        comm.sum(std::span<double>(sums));
        EXPECT_LT(comm.max(worst), 0.015 * rho * g * level);
        EXPECT_LT(-comm.max(-lowest), 0.5 * dx) << "some are within half a cell of the floor";
        const double slope = (sums[0] * sums[4] - sums[1] * sums[2]) / (sums[0] * sums[3] - sums[1] * sums[1]);
        EXPECT_NEAR(slope, -rho * g, 0.01 * rho * g);
        EXPECT_NEAR((sums[2] - slope * sums[1]) / sums[0], rho * g * level, 0.01 * rho * g * level) << "at the floor";
    }
}

// As long as a period, with what its images add.
TEST_F(GridWalls, ALidAsLongAsThePeriodShearsTheLiquid) {
    auto sample = channel(16, 1e4);
    scene::Shape shape;
    shape.min = {-0.5, 0.8, 0};
    shape.max = {1, 1, 0};
    rigid::BodySetup lid;
    lid.kind = scene::BodyKind::kinematic;
    lid.velocity = {2, 0, 0};
    lid.centre = {0.25, 0.9, 0};
    lid.region = {scene::SolidRegion(shape, 2)};
    lid.bounding_radius = 1;
    sample.setup.rigid.bodies = {lid};
    sample.setup.rigid.period = {0.5, 0, 0};
    sample.setup.slip = {{scene::Slip::no_slip}, {0.0}};
    sample.liquid = [](const Vec3& x) { return x[1] - 0.8; };
    auto step = started(comm, sample);
    StepReport report;
    for (int k = 0; k < 30; ++k) report = step->advance(0.01);
    EXPECT_LT(error_of(comm, *step, 0, 2.5), 0.03);
    const double drag = 1e4 * 2.5 * 0.5;
    EXPECT_NEAR(report.viscous_loads[0], -drag, 0.02 * drag);
    EXPECT_NEAR(report.resting_viscous_loads[6 * 2], drag, 0.02 * drag);
}

} // namespace
} // namespace treacle::grid::walls_test
