#include "sample.hpp"

#include <gtest/gtest.h>

namespace treacle::sph::multilevel_test {
namespace {

constexpr double dt = 4e-3; // [s]

SphOptions with(PressurePreconditioner preconditioner, double residual) {
    SphOptions options;
    options.pressure.solver = PressureSolver::isph;
    options.pressure.preconditioner = preconditioner;
    options.pressure.stop = StoppingRule::residual;
    options.pressure.residual = residual;
    return options;
}

// Liquid out of order that fills a tank to three quarters, each particle with the pressure of its depth.
Sample tank(int n, int dimensions, const SphOptions& options) {
    const double edge = n * spacing;
    const auto domain = make_domain(dimensions, {0, 0, 0}, {edge, edge, dimensions == 3 ? edge : spacing});
    Sample sample{make_setup(domain, options), {}, {}};
    const std::size_t up = dimensions == 3 ? 2 : 1;
    sample.setup.forces.gravity[up] = -9.81;
    std::array<int, 3> count{n, n, dimensions == 3 ? n : 1};
    count[up] = 3 * n / 4;
    const double half = spacing / 2;
    add_block(sample, {.corner = {half, half, dimensions == 3 ? half : 0}, .count = count, .jitter = 0.2});
    for (auto& point : sample.liquid) point.p = rest_density * 9.81 * (count[up] * spacing - point.x[up]);
    if (dimensions == 3) add_shell(sample, {-half, -half, -half}, {n + 2, n + 2, n + 2}, 0);
    return sample;
}

// One step, with the roles by the given pressures.
std::unique_ptr<IsphStep> stepped(const Comm& comm, const Sample& sample, StepReport& report) {
    auto step = started(comm, sample);
    step->start(IsphStep::SolidVolumes::keep);
    report = step->advance(dt);
    return step;
}

double largest_difference(const std::map<std::int64_t, State>& a, const std::map<std::int64_t, State>& b) {
    EXPECT_EQ(a.size(), b.size());
    double most = 0, scale = 0;
    for (const auto& [id, state] : a) {
        most = std::max(most, std::abs(state.p - b.at(id).p));
        scale = std::max(scale, std::abs(state.p));
    }
    return most / scale;
}

} // namespace

class EachHierarchy : public testing::TestWithParam<PressurePreconditioner> {
protected:
    const Comm comm = Comm::world();
};
INSTANTIATE_TEST_SUITE_P(all, EachHierarchy,
    testing::Values(PressurePreconditioner::multilevel, PressurePreconditioner::multilevel_rediscretised),
    [](const auto& info) {
        return std::string(info.param == PressurePreconditioner::multilevel ? "galerkin" : "grids");
    });

TEST_P(EachHierarchy, gives_the_pressures_that_jacobi_gives_in_space_and_in_the_plane) {
    for (const int dimensions : {2, 3}) {
        StepReport report, reference;
        const int n = dimensions == 3 ? 12 : 24;
        const auto step = stepped(comm, tank(n, dimensions, with(GetParam(), 1e-12)), report);
        const auto other = stepped(comm, tank(n, dimensions, with(PressurePreconditioner::jacobi, 1e-12)), reference);
        EXPECT_GT(reference.roles.poisson, 100);
        EXPECT_LT(report.pressure.iterations, reference.pressure.iterations);
        // The residual's 1e-12 times a condition number of some hundreds.
        EXPECT_LE(largest_difference(all_states(comm, other->liquid()), all_states(comm, step->liquid())), 1e-9);
    }
}

TEST_P(EachHierarchy, takes_few_iterations_on_any_number_of_ranks) {
    StepReport report;
    const auto step = stepped(comm, tank(20, 3, with(GetParam(), 1e-6)), report);
    EXPECT_GT(step->system().global_rows(), 5000);
    RecordProperty("iterations", report.pressure.iterations);
    // Measured on 1 to 8 ranks, and a few more.
    EXPECT_LE(report.pressure.iterations, GetParam() == PressurePreconditioner::multilevel ? 12 : 25);
}

TEST_P(EachHierarchy, takes_few_iterations_with_a_heavy_liquid_on_a_light_one) {
    auto sample = tank(20, 3, with(GetParam(), 1e-6));
    sample.setup.constants.immiscible =
        make_immiscible_liquids(std::vector<LiquidMaterial>{{rest_density, 0}, {rest_density / 10, 0}});
    for (auto& point : sample.liquid) point.liquid = point.x[2] < 7 * spacing ? 1 : 0;
    StepReport report;
    const auto step = stepped(comm, sample, report);
    RecordProperty("iterations", report.pressure.iterations);
    // Measured on 1 to 8 ranks, and a few more.
    EXPECT_LE(report.pressure.iterations, GetParam() == PressurePreconditioner::multilevel ? 12 : 25);
}

TEST(ChebyshevHierarchy, takes_hardly_more_iterations_than_sweeps_and_the_same_on_any_number_of_ranks) {
    for (const double residual : {1e-3, 1e-6}) {
        const auto iterations = [&](const Comm& comm, solve::Smoother smoother) {
            auto options = with(PressurePreconditioner::multilevel, residual);
            options.pressure.multilevel.smoother = smoother;
            StepReport report;
            stepped(comm, tank(20, 3, options), report);
            return report.pressure.iterations;
        };
        const int alone = iterations(Comm::self(), solve::Smoother::chebyshev);
        EXPECT_LE(alone, iterations(Comm::self(), solve::Smoother::gauss_seidel) + 1);
        EXPECT_NEAR(iterations(Comm::world(), solve::Smoother::chebyshev), alone, 1);
        RecordProperty(residual < 1e-4 ? "to_1e-6" : "to_1e-3", alone);
    }
}

} // namespace treacle::sph::multilevel_test
