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

// Errors of the measure, over its first value, against `exact`: with `cells` and `steps`, twice and four times as many.
std::array<double, 3> errors(const std::function<StepSample(int)>& sample, int cells, double end, int steps,
    const Measure& measure, double exact) {
    std::array<double, 3> error{};
    for (std::size_t k = 0; k < 3; ++k) {
        auto step = started(Comm::world(), sample(cells << k));
        const double first = measure(*step);
        const int n = steps << k;
        for (int i = 0; i < n; ++i) step->advance(end / n);
        step->refresh();
        error[k] = std::fabs(measure(*step) / first - exact);
    }
    return error;
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
    const auto error = errors(
        sample, 24, end, 20, [](const GridStep& s) { return centre(s, 0) - 0.5; }, std::cos(omega * end));
    RecordProperty("standing wave, errors",
        std::to_string(error[0]) + " " + std::to_string(error[1]) + " " + std::to_string(error[2]));
    EXPECT_LT(error[2], 0.016);
    EXPECT_LT(error[2], 0.5 * error[0]);
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
