#include "solve/runtime.hpp"
#include "step_sample.hpp"

#include <gtest/gtest.h>

#include <cstdio>

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
        out.about_centre[k] = totals.angular_momentum[k] - out.centre[a] * out.momentum[b] + out.centre[b] * out.momentum[a];
    }
    return out;
}

Motion run(const StepSample& sample, double end, double cfl) {
    auto step = started(Comm::world(), sample);
    double time = 0;
    int steps = 0;
    while (time < end * (1 - 1e-9)) {
        const double limit = step->stable_step(cfl), left = end - time;
        const double dt = left / std::max(1.0, std::ceil(left / limit));
        step->advance(dt);
        time += dt;
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

TEST(TimeTest, Table) {
    for (const int dimensions : {2, 3}) {
    for (const double viscosity : {0.0, 1.0, 100.0, 1e5}) {
        for (const double cfl : {3.0, 0.3}) {
            if (dimensions == 3 && cfl < 1) continue;
            for (const Vec3 flight : {Vec3{0, 0, 0}, Vec3{1.3, 0, 0}}) {
                const auto sample = ball(dimensions, 10, viscosity, flight);
                const auto start = motion_of(*started(Comm::world(), sample));
                const auto end = run(sample, 1, cfl);
                if (Comm::world().is_root())
                    std::printf("dim %d eta %g cfl %g flight %g: steps %d L %.4f E %.4f size %.4f off %.5f %.5f p %.2e\n", dimensions, viscosity, cfl, flight[0], end.steps,
                                end.about_centre[2] / start.about_centre[2], (end.energy-0.5*end.mass*flight[0]*flight[0]) / (start.energy-0.5*start.mass*flight[0]*flight[0]), end.size / start.size,
                                end.centre[0] - start.centre[0] - flight[0], end.centre[1] - start.centre[1], end.momentum[0] - start.momentum[0]);
                std::fflush(stdout);
            }
        }
    }
    }
}

} // namespace
} // namespace treacle::grid
