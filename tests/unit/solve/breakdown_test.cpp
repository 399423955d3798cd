#include "base/text/error.hpp"
#include "fixture.hpp"
#include "solve/krylov/krylov.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace treacle::solve::breakdown_test {

namespace {

// Diagonal matrix with the given entries, repeated.
TestSystem diagonal(const Comm& comm, Index n, std::vector<double> entries) {
    return TestSystem(comm, n, [entries](Index i) {
        return std::vector<TestSystem::Entry>{{i, entries[static_cast<std::size_t>(i) % entries.size()]}};
    });
}

struct Result {
    SolveReport report;
    std::vector<double> x;
};

Result solve(TestSystem system, std::vector<double> b, KrylovOptions options,
    const ConvergenceTest& test = ConvergenceTest::residual(1e-10)) {
    const auto comm = Comm::world();
    Matrix matrix(comm, system.blocks());
    KrylovSolver solver(comm, "test", options);
    std::vector<double> x(b.size(), 0.0);
    auto report = solver.solve(matrix, b, x, test);
    return {report, x};
}

KrylovOptions plain(Preconditioner preconditioner = Preconditioner::none) {
    KrylovOptions options;
    options.preconditioner = preconditioner;
    return options;
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

} // namespace

TEST(Breakdown, an_indefinite_matrix_is_reported) {
    auto system = diagonal(Comm::world(), 12, {1, 2, -3});
    const auto b = system.values(noise);
    const auto [report, x] = solve(system, b, plain());
    EXPECT_EQ(report.outcome, Outcome::indefinite_matrix) << report.reason;
}

TEST(Breakdown, a_negative_definite_matrix_is_reported_at_once) {
    auto system = diagonal(Comm::world(), 12, {-1, -2, -3});
    const auto b = system.values(noise);
    const auto [report, x] = solve(system, b, plain());
    EXPECT_EQ(report.outcome, Outcome::indefinite_matrix);
    EXPECT_EQ(report.iterations, 0);
    for (const double value : x) EXPECT_EQ(value, 0);
}

TEST(Breakdown, a_preconditioner_that_is_not_positive_is_reported) {
    auto system = diagonal(Comm::world(), 12, {1, 2, 3});
    const auto b = system.values(noise);
    KrylovOptions options;
    options.user.apply = [](std::span<const double> r, std::span<double> z) {
        for (std::size_t i = 0; i < r.size(); ++i) z[i] = -r[i];
    };
    EXPECT_EQ(solve(system, b, options).report.outcome, Outcome::indefinite_preconditioner);
}

TEST(Breakdown, directions_that_are_spoiled_late_are_begun_anew) {
    for (const int when : {2, 25}) { // of the applications of the preconditioner, the one that is wrong
        const auto comm = Comm::world();
        auto system = poisson(comm, 10, Border::dirichlet);
        const auto b = system.product(noise);
        int applied = 0;
        KrylovOptions options;
        options.user.apply = [&applied, when](std::span<const double> r, std::span<double> z) {
            const double sign = ++applied == when ? -1 : 1;
            for (std::size_t i = 0; i < r.size(); ++i) z[i] = sign * r[i];
        };
        const auto [report, x] = solve(system, b, options);
        EXPECT_EQ(report.outcome, when == 2 ? Outcome::indefinite_preconditioner : Outcome::converged) << when;
        EXPECT_TRUE(when == 2 || report.relative_residual <= 1e-10);
    }
}

TEST(Breakdown, a_right_hand_side_that_is_not_finite_on_one_rank_is_reported_on_all) {
    const auto comm = Comm::world();
    auto system = diagonal(comm, 12, {1, 2, 3});
    for (const double bad : {nan, std::numeric_limits<double>::infinity()}) {
        auto b = system.values(noise);
        if (comm.rank() == comm.size() - 1) b.back() = bad;
        EXPECT_EQ(solve(system, b, plain()).report.outcome, Outcome::non_finite);
    }
}

TEST(Breakdown, a_matrix_that_is_not_finite_is_reported_before_any_set_up) {
    for (const auto preconditioner : {Preconditioner::ic0, Preconditioner::gamg, Preconditioner::boomeramg}) {
        auto system = diagonal(Comm::world(), 12, {1, nan, 3});
        const auto b = system.values(noise);
        EXPECT_EQ(solve(system, b, plain(preconditioner)).report.outcome, Outcome::non_finite);
    }
}

TEST(Breakdown, a_measure_that_is_not_finite_is_reported) {
    auto system = diagonal(Comm::world(), 12, {1, 2, 3});
    const auto b = system.values(noise);
    const auto test = ConvergenceTest::measure([](std::span<const double>) { return nan; }, 1.0);
    EXPECT_EQ(solve(system, b, plain(), test).report.outcome, Outcome::non_finite);
}

TEST(Breakdown, a_measure_that_no_solution_satisfies_is_reported) {
    auto system = diagonal(Comm::world(), 12, {2.0});
    const auto b = system.values([](Index) { return 1.0; });
    const auto test = ConvergenceTest::measure([](std::span<const double>) { return 1.0; }, 0.5);
    EXPECT_EQ(solve(system, b, plain(), test).report.outcome, Outcome::stagnated);
}

TEST(Breakdown, the_iteration_limit_is_reported_with_the_last_iterate) {
    const auto comm = Comm::world();
    auto system = poisson(comm, 10, Border::dirichlet);
    const auto b = system.product(noise);
    auto options = plain();
    options.max_iterations = 5;
    const auto [report, x] = solve(system, b, options);
    EXPECT_EQ(report.outcome, Outcome::iteration_limit);
    EXPECT_EQ(report.iterations, 5);
    EXPECT_NE(report.reason.find("5 iterations"), std::string::npos);
    EXPECT_LT(report.relative_residual, 0.5);
    EXPECT_GT(report.relative_residual, 1e-10);
}

// Positive definite, yet incomplete Cholesky without a shift meets a negative pivot (Kershaw 1978).
TEST(Breakdown, ic0_shifts_itself_where_incomplete_cholesky_breaks_down) {
    const double rows[4][4] = {{3, -2, 0, 2}, {-2, 3, -2, 0}, {0, -2, 3, -2}, {2, 0, -2, 3}};
    auto row = [&rows](Index i) {
        std::vector<TestSystem::Entry> entries;
        for (Index j = 0; j < 4; ++j) {
            if (rows[i % 4][j] != 0) entries.emplace_back(i / 4 * 4 + j, rows[i % 4][j]);
        }
        return entries;
    };
    TestSystem system(Comm::world(), 16, row);
    const auto b = system.product(noise);
    const auto [report, x] = solve(system, b, plain(Preconditioner::ic0));
    EXPECT_TRUE(report.converged()) << report.reason;
    EXPECT_LE(distance(Comm::world(), x, system.values(noise)), 1e-7);
}

} // namespace treacle::solve::breakdown_test
