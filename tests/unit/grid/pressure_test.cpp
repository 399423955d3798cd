#include "../sph/solver_environment.hpp"
#include "pressure_sample.hpp"

#include <gtest/gtest.h>

namespace treacle::grid::pressure_test {
namespace {

[[maybe_unused]] const auto* const solvers = testing::AddGlobalTestEnvironment(new sph::SolverEnvironment);

constexpr double dt = 1e-2;           // [s]
const Vec3 gravity{0.3, -0.2, -9.81}; // [m/s2]
const Vec3 middle{0.5, 0.5, 0.5};

double along(const Vec3& n, const Vec3& x) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += n[k] * (x[k] - middle[k]);
    return sum;
}

// Below a surface at right angles to gravity.
Distance pool(const Vec3& g, double level) {
    const double size = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    return [=](const Vec3& x) { return -along(g, x) / size - level; };
}

Distance ball(const Vec3& centre, double radius) {
    return [=](const Vec3& x) {
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) sum += (x[k] - centre[k]) * (x[k] - centre[k]);
        return std::sqrt(sum) - radius;
    };
}

PressureSample tight(int cells) {
    PressureSample sample;
    sample.cells = cells;
    sample.options.residual = 1e-12;
    return sample;
}

class Pressures : public testing::Test {
protected:
    const Comm comm = Comm::world();
};

TEST_F(Pressures, HoldLiquidAtRestOnATiltedSolid) {
    auto sample = tight(32);
    sample.liquid = pool(gravity, 0.123);
    sample.solid = [](const Vec3& x) { return along({0.48, 0.36, 0.8}, x) + 0.31; };
    PressureCase test(comm, sample);
    test.build();
    test.accelerate(gravity, dt);
    const auto report = test.project(dt);
    EXPECT_GT(report.unknowns, 10000);
    // The solve's residual times the velocity of one step.
    EXPECT_LT(test.max_speed(), 1e-10);
    // Hydrostatic: rho g times the depth.
    double most = 0;
    test.each_owned([&](std::size_t at, const int*) {
        if (test.pressure.system().row_of()(at) < 0) return;
        const double depth = -test.distance(at);
        const double expected = 1000 * std::sqrt(0.09 + 0.04 + 9.81 * 9.81) * depth;
        most = std::max(most, std::fabs(test.pressure.pressures()(at) - expected));
    });
    EXPECT_LT(most, 1e-6);
}

TEST_F(Pressures, LeaveNoDivergence) {
    for (const int dimensions : {2, 3}) {
        auto sample = tight(16);
        sample.dimensions = dimensions;
        sample.liquid =
            dimensions == 3 ? ball(middle, 0.42) : Distance([](const Vec3& x) { return x[1] - 0.71 + 0.2 * x[0]; });
        sample.solid = ball({0.6, 0.3, dimensions == 3 ? 0.5 : 0}, 0.21);
        PressureCase test(comm, sample);
        test.build();
        test.set_velocity(noise);
        const double before = test.max_flux();
        test.project(dt);
        EXPECT_LT(test.max_flux(), 1e-10 * before) << dimensions; // the residual of the solve, times the cells' number
    }
}

TEST_F(Pressures, OfAClosedPeriodicBoxWithoutAirAreFound) {
    auto sample = tight(16);
    sample.periodic = {true, false, true};
    sample.solid = ball({0.6, 0.3, 0.5}, 0.21);
    PressureCase test(comm, sample);
    test.build();
    test.set_velocity(noise);
    const double before = test.max_flux();
    const auto report = test.project(dt);
    EXPECT_EQ(report.closed, 1);
    EXPECT_LT(report.incompatible_fraction, 1e-12); // no flux through solids at rest
    EXPECT_LT(test.max_flux(), 1e-10 * before);
}

// Two chambers side by side, one of them open to air above.
TEST_F(Pressures, OfEachClosedPartHaveAConstantOfTheirOwn) {
    auto sample = tight(16);
    sample.liquid = [](const Vec3& x) { return x[0] < 0.5 ? -1 : x[2] - 0.65; };
    sample.solid = [](const Vec3& x) { return std::fabs(x[0] - 0.5) - 1.1 / 16; };
    PressureCase test(comm, sample);
    test.build();
    test.accelerate(gravity, dt);
    const auto report = test.project(dt);
    EXPECT_EQ(report.closed, 1);
    test.set_velocity(noise);
    const double before = test.max_flux();
    test.project(dt);
    EXPECT_LT(test.max_flux(), 1e-10 * before);
}

TEST_F(Pressures, TakeFewIterationsWhateverTheSize) {
    struct Variant {
        solve::Smoother smoother;
        const char* name;
        int most;
    };
    // On 1 to 8 ranks 12 and 13, Chebyshev 11 and 12.
    for (const auto& [smoother, name, most] : {Variant{solve::Smoother::gauss_seidel, "iterations_", 13},
             Variant{solve::Smoother::chebyshev, "iterations_chebyshev_", 12}}) {
        for (const int cells : {24, 48}) {
            auto sample = tight(cells);
            sample.options.residual = 1e-10;
            sample.options.smoother = smoother;
            sample.liquid = [](const Vec3& x) { return x[2] - 0.62 - 0.1 * std::sin(9 * x[0]) * std::cos(7 * x[1]); };
            sample.solid = ball({0.6, 0.3, 0.4}, 0.17);
            PressureCase test(comm, sample);
            test.build();
            test.set_velocity([](int a, const Vec3& x) { return (a == 2 ? -1 : 0) + 0.3 * noise(a, x); });
            const auto report = test.project(dt);
            EXPECT_LE(report.solve.iterations, most) << name << report.unknowns;
            RecordProperty(name + std::to_string(cells), report.solve.iterations);
        }
    }
}

TEST_F(Pressures, AreTheSameOnOneRankAndOnAll) {
    auto sample = tight(16);
    sample.liquid = pool(gravity, -0.03);
    sample.solid = ball({0.6, 0.3, 0.4}, 0.17);
    PressureCase together(comm, sample), alone(Comm::self(), sample);
    for (auto* test : {&together, &alone}) {
        test->build();
        test->set_velocity(noise);
        test->project(dt);
    }
    double most = 0, scale = 0;
    together.each_owned([&](std::size_t at, const int c[3]) {
        const auto there = static_cast<std::size_t>(alone.halo.window().index(c[0], c[1], c[2]));
        most = std::max(most, std::fabs(together.pressure.pressures()(at) - alone.pressure.pressures()(there)));
        scale = std::max(scale, std::fabs(alone.pressure.pressures()(there)));
    });
    EXPECT_LE(comm.max(most), 1e-9 * comm.max(scale)); // both residuals, times the condition
}

// By its exact curvature; and by that of the shares of liquid that cells hold, 7 cells a radius.
TEST_F(Pressures, OfARoundDropAreThoseOfItsSurfaceTension) {
    for (const bool exact : {true, false})
        for (const int dimensions : {2, 3}) {
            auto sample = tight(24);
            sample.dimensions = dimensions;
            sample.liquid = ball({0.5, 0.5, dimensions == 3 ? 0.5 : 0}, 0.31);
            sample.surface_tension = 0.07;
            if (exact) sample.curvature = (dimensions - 1) / 0.31;
            PressureCase test(comm, sample);
            test.build();
            test.project(dt);
            const double expected = (dimensions - 1) * 0.07 / 0.31;
            double most = 0;
            test.each_owned([&](std::size_t at, const int*) {
                if (test.wet(at)) most = std::max(most, std::fabs(test.pressure.pressures()(at) / expected - 1));
            });
            EXPECT_LT(comm.max(most), exact ? 1e-6 : 0.04) << dimensions;
        }
}

} // namespace
} // namespace treacle::grid::pressure_test
