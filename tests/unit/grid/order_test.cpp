#include "../sph/solver_environment.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

// The order of the step in time, by cells and steps that become smaller together: what is exchanged with the faces loses a little in
// each step, so that shorter steps alone lose more.
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

// The measure at the end over its first value: with `cells` and `steps`, twice and four times as many.
std::array<double, 3> measured(
    const std::function<StepSample(int)>& sample, int cells, double end, int steps, const Measure& measure) {
    std::array<double, 3> out{};
    for (std::size_t k = 0; k < 3; ++k) {
        auto step = started(Comm::world(), sample(cells << k));
        const double first = measure(*step);
        const int n = steps << k;
        for (int i = 0; i < n; ++i) step->advance(end / n);
        step->refresh();
        out[k] = measure(*step) / first;
    }
    return out;
}

std::array<double, 3> errors(const std::function<StepSample(int)>& sample, int cells, double end, int steps,
    const Measure& measure, double exact) {
    auto error = measured(sample, cells, end, steps, measure);
    for (double& one : error) one = std::fabs(one - exact);
    return error;
}

// By how much less the finer two differ than the coarser two: what the exact answer leaves out is in all three.
void check_differences(const char* what, const std::array<double, 3>& of, double asked) {
    const double order = std::log2(std::fabs(of[0] - of[1]) / std::fabs(of[1] - of[2]));
    testing::Test::RecordProperty(what, std::to_string(order));
    EXPECT_GE(order, asked) << what << ' ' << of[0] << ' ' << of[1] << ' ' << of[2];
}

void check(const char* what, const std::array<double, 3>& error, double asked) {
    const double order = 0.5 * std::log2(error[0] / error[2]);
    testing::Test::RecordProperty(what, std::to_string(order));
    EXPECT_GE(order, asked) << what;
}

StepSample smooth(int cells) {
    auto sample = sample_of(cells, 2);
    sample.jitter = 0;
    sample.setup.options.correction.method = PositionMethod::none;
    sample.setup.options.density_relaxation.steps = 0;
    return sample;
}

// The middle of the liquid swings along x by cos(w t), w^2 = g k tanh(k h), but for the square of the steepness a k, which over
// five radians is what is left with 96 cells.
TEST(OrderInTime, OfAStandingWave) {
    const double k = math::pi, omega = std::sqrt(9.81 * k * std::tanh(0.5 * k));
    const auto sample = [](int cells) {
        auto out = smooth(cells);
        out.liquid = [](const Vec3& x) { return x[1] - 0.5 - 0.04 * std::cos(math::pi * x[0]); };
        return out;
    };
    const double end = 1.0;
    const auto swung = measured(sample, 24, end, 20, [](const GridStep& s) { return centre(s, 0) - 0.5; });
    check_differences("standing wave", swung, 1.8);
    EXPECT_NEAR(swung[2], std::cos(omega * end), 0.016);
}

// A drop that a stretch of a twentieth lets swing, for a quarter of Lamb's period. No order is seen: at steps that are stable the
// error in time is below what the transfers lose in as many of them (0.0013 for each halving of the steps alone).
TEST(OrderInTime, OfASwingingDrop) {
    constexpr double radius = 1e-3, tension = 0.072;
    const auto sample = [](int cells) {
        auto out = smooth(10);
        auto& domain = out.setup.domain;
        domain.spacing = out.setup.rigid.spacing = radius / cells;
        domain.min = {-1.5 * radius, -1.5 * radius, 0};
        domain.max = {1.5 * radius, 1.5 * radius, 0};
        for (auto& face : domain.faces) face.kind = scene::BoundaryKind::open;
        domain.gravity = out.setup.rigid.gravity = {0, 0, 0};
        out.setup.surface_tension = {tension};
        out.liquid = [](const Vec3& x) {
            const double r = std::max(std::hypot(x[0], x[1]), 1e-30);
            return r - radius * (1 + 0.05 * (x[0] * x[0] - x[1] * x[1]) / (r * r));
        };
        return out;
    };
    const auto stretch = [](const GridStep& step) {
        const auto& p = step.particles();
        double sum = 0;
        for (int i = 0; i < p.store.owned(); ++i)
            sum += p.position()(i, 0) * p.position()(i, 0) - p.position()(i, 1) * p.position()(i, 1);
        return step.comm().sum(sum);
    };
    const double omega = std::sqrt(6 * tension / (1000 * radius * radius * radius));
    const auto left = measured(sample, 8, 0.5 * math::pi / omega, 80, stretch);
    RecordProperty("swinging drop, errors",
        std::to_string(left[0]) + " " + std::to_string(left[1]) + " " + std::to_string(left[2]));
    EXPECT_LT(std::fabs(left[0]), 0.015);
    for (const double one : {left[1], left[2]}) EXPECT_LT(std::fabs(one), 0.006);
}

TEST(OrderInTime, OfATaylorGreenVortex) {
    const double k = 2 * math::pi;
    for (const double viscosity : {0.0, 10.0}) {
        const auto sample = [=](int cells) {
            auto out = smooth(cells);
            out.setup.viscosity = viscosity;
            for (auto& face : out.setup.domain.faces) face.kind = scene::BoundaryKind::periodic;
            out.setup.domain.gravity = out.setup.rigid.gravity = {0, 0, 0};
            out.liquid = [](const Vec3&) { return -1.0; };
            out.velocity = [=](const Vec3& x) {
                return Vec3{std::sin(k * x[0]) * std::cos(k * x[1]), -std::cos(k * x[0]) * std::sin(k * x[1]), 0};
            };
            return out;
        };
        const double end = 0.25, exact = std::exp(-4 * viscosity / 1000 * k * k * end);
        check(viscosity > 0 ? "viscous vortex" : "vortex",
            errors(
                sample, 16, end, 8, [](const GridStep& s) { return s.totals().kinetic_energy; }, exact),
            viscosity > 0 ? 1 : 1.8);
    }
}

TEST(OrderInTime, OfFreeFall) {
    auto sample = smooth(16);
    for (auto& face : sample.setup.domain.faces) face.kind = scene::BoundaryKind::open;
    sample.liquid = [](const Vec3& x) { return std::hypot(x[0] - 0.5, x[1] - 0.7) - 0.15; };
    auto step = started(Comm::world(), sample);
    const double first = centre(*step, 1);
    for (int i = 0; i < 4; ++i) step->advance(0.05);
    step->refresh();
    EXPECT_NEAR(first - centre(*step, 1), 0.5 * 9.81 * 0.04, 1e-5); // parabolas are exact
}

} // namespace
} // namespace treacle::grid
