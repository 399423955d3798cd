#include "../sph/solver_environment.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

#include <numeric>

// The order of the step in time: steps of 1, 1/2 and 1/4, the grid stays.
namespace treacle::grid {
namespace {

[[maybe_unused]] const auto* const solvers = testing::AddGlobalTestEnvironment(new sph::SolverEnvironment);

using Measure = std::function<double(const GridStep&)>;

double centre(const GridStep& step, std::size_t axis) {
    const auto& p = step.particles();
    double sum[2] = {0, 0};
    for (int i = 0; i < p.store.owned(); ++i) {
        sum[0] += p.position()(i, axis);
        sum[1] += 1;
    }
    step.comm().sum(std::span<double>(sum));
    return sum[0] / sum[1];
}

// log2 of how much less the result changes with half the steps.
double order(const StepSample& sample, double end, int steps, const Measure& measure) {
    std::array<double, 3> found{};
    for (std::size_t k = 0; k < 3; ++k) {
        auto step = started(Comm::world(), sample);
        const int n = steps << k;
        for (int i = 0; i < n; ++i) step->advance(end / n);
        step->refresh();
        found[k] = measure(*step);
    }
    std::printf("  %.9g %.9g %.9g\n", found[0], found[1], found[2]);
    return std::log2(std::fabs((found[0] - found[1]) / (found[1] - found[2])));
}

void check(const char* what, double found, double asked) {
    testing::Test::RecordProperty(what, std::to_string(found));
    std::printf("%s: order %.2f\n", what, found);
    EXPECT_GE(found, asked) << what;
}

StepSample smooth(int cells) {
    auto sample = sample_of(cells, 2);
    sample.jitter = 0;
    sample.setup.options.correction.method = PositionMethod::none;
    sample.setup.options.contraction.steps = 0;
    return sample;
}

TEST(OrderInTime, OfAStandingWave) {
    for (const double viscosity : {0.0, 1.0}) {
        auto sample = smooth(32);
        sample.setup.viscosity = viscosity;
        sample.liquid = [](const Vec3& x) { return x[1] - 0.5 - 0.05 * std::cos(math::pi * x[0]); };
        check(viscosity > 0 ? "viscous wave" : "standing wave", order(sample, 0.2, 8, [](const GridStep& s) { return centre(s, 0); }),
              viscosity > 0 ? 1 : 1.8);
    }
}

TEST(OrderInTime, OfATaylorGreenVortex) {
    for (const double viscosity : {0.0, 10.0}) {
        auto sample = smooth(32);
        sample.setup.viscosity = viscosity;
        for (auto& face : sample.setup.domain.faces) face.kind = scene::FaceKind::periodic;
        sample.setup.domain.gravity = sample.setup.rigid.gravity = {0, 0, 0};
        sample.liquid = [](const Vec3&) { return -1.0; };
        const double k = 2 * math::pi;
        sample.velocity = [=](const Vec3& x) { return Vec3{std::sin(k * x[0]) * std::cos(k * x[1]), -std::cos(k * x[0]) * std::sin(k * x[1]), 0}; };
        check(viscosity > 0 ? "viscous vortex" : "vortex", order(sample, 0.1, 8, [](const GridStep& s) { return s.totals().kinetic_energy; }),
              viscosity > 0 ? 1 : 1.8);
    }
}

TEST(OrderInTime, OfFreeFall) {
    auto sample = smooth(16);
    for (auto& face : sample.setup.domain.faces) face.kind = scene::FaceKind::open;
    sample.liquid = [](const Vec3& x) { return std::hypot(x[0] - 0.5, x[1] - 0.7) - 0.15; };
    auto step = started(Comm::world(), sample);
    const double first = centre(*step, 1);
    for (int i = 0; i < 4; ++i) step->advance(0.05);
    step->refresh();
    EXPECT_NEAR(first - centre(*step, 1), 0.5 * 9.81 * 0.04, 1e-5); // parabolas are exact
}

TEST(OrderInTime, OfASwingingDrop) {
    auto sample = smooth(40);
    for (auto& face : sample.setup.domain.faces) face.kind = scene::FaceKind::open;
    sample.setup.domain.gravity = sample.setup.rigid.gravity = {0, 0, 0};
    sample.setup.surface_tension = {50};
    sample.liquid = [](const Vec3& x) { return std::hypot((x[0] - 0.5) / 1.1, (x[1] - 0.5) * 1.1) - 0.25; };
    check("drop", order(sample, 0.06, 30, [](const GridStep& s) { return s.totals().kinetic_energy; }), 1.8);
}

} // namespace
} // namespace treacle::grid
