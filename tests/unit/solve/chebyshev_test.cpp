#include "multilevel_sample.hpp"
#include "solve/multigrid/chebyshev.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace treacle::solve::chebyshev_test {

using multilevel_test::Cell;
using multilevel_test::pair_cell;
using multilevel_test::poisson_sample;
using multilevel_test::Sample;
using multilevel_test::variant;

namespace {

// A level that is the matrix itself, and its smoother.
struct Smoothed {
    Comm comm;
    TestSystem system;
    Matrix matrix;
    Level level;
    Chebyshev chebyshev;

    Smoothed(const Comm& group, TestSystem given)
        : comm(group), system(std::move(given)), matrix(comm, system.blocks()) {
        level.refer_to(matrix);
        chebyshev.set_up(comm, level);
    }
};

TestSystem diagonal(const Comm& comm, Index rows, const std::function<double(Index)>& entry) {
    return TestSystem(comm, rows, [entry](Index i) { return std::vector<TestSystem::Entry>{{i, entry(i)}}; });
}

// 1 - x q(x) = T2((theta - x) / delta) / T2(theta / delta), theta and delta of [0.3, 1] times the bound over 1.1.
double error_share(double x, double bound) {
    const auto t2 = [](double y) { return 2 * y * y - 1; };
    const double end = bound / 1.1, centre = 0.65 * end, half_width = 0.35 * end;
    return t2((centre - x) / half_width) / t2(centre / half_width);
}

// Chains of rows coupled by -1, their first ones held; every tenth row has no entry but zero.
TestSystem chains_with_zeros(const Comm& comm, Index rows) {
    return TestSystem(comm, rows, [](Index i) {
        if (i % 10 == 9) return std::vector<TestSystem::Entry>{{i, 0.0}};
        std::vector<TestSystem::Entry> row;
        if (i % 10 > 0) row.emplace_back(i - 1, -1.0);
        row.emplace_back(i, i % 10 == 8 ? 1.0 : 2.0);
        if (i % 10 < 8) row.emplace_back(i + 1, -1.0);
        return row;
    });
}

} // namespace

TEST(Chebyshev, of_a_diagonal_matrix_leaves_the_polynomials_share_of_the_error) {
    const auto comm = Comm::world();
    Smoothed of(comm, diagonal(comm, 37, [](Index i) { return 0.25 + double(i); }));
    EXPECT_EQ(of.chebyshev.eigenvalue_bound(), 1);
    const double left = error_share(1, 1);
    const auto r = of.system.values(noise),
               exact = of.system.values([](Index i) { return noise(i) / (0.25 + double(i)); });
    std::vector<double> z(r.size());
    of.chebyshev.start(of.level, r, z);
    for (std::size_t i = 0; i < r.size(); ++i) EXPECT_NEAR(z[i], (1 - left) * exact[i], 1e-14);
    of.chebyshev.improve(of.level, r, z);
    for (std::size_t i = 0; i < r.size(); ++i) EXPECT_NEAR(z[i], (1 - left * left) * exact[i], 1e-14);
}

// Signs that alternate from row to row, whose eigenvalue in a closed box is the bound.
TEST(Chebyshev, reduces_the_mode_of_the_largest_eigenvalue_that_there_can_be) {
    const auto comm = Comm::world();
    for (const Index n : {2, 7}) {
        Smoothed of(comm, poisson(comm, n, Border::closed));
        const auto mode = [n](Index i) { return (i % n + i / n % n + i / (n * n)) % 2 == 0 ? 1.0 : -1.0; };
        const auto exact = of.system.values(mode), r = of.system.product(mode);
        std::vector<double> z(r.size());
        of.chebyshev.start(of.level, r, z);
        EXPECT_EQ(of.chebyshev.eigenvalue_bound(), 2);
        EXPECT_LT(error_share(2, 2), 0.4);
        for (std::size_t i = 0; i < r.size(); ++i) EXPECT_NEAR(exact[i] - z[i], error_share(2, 2) * exact[i], 1e-14);
    }
}

TEST(Chebyshev, bounds_the_eigenvalues_alike_on_any_number_of_ranks) {
    const auto comm = Comm::world();
    for (const Index n : {1, 2, 3, 12}) {
        for (const int owners : {1, 2, 1 << 20}) {
            Smoothed of(comm, poisson(comm, n, Border::dirichlet, owners));
            EXPECT_DOUBLE_EQ(of.chebyshev.eigenvalue_bound(), n == 1 ? 1 : n == 2 ? 1.5 : 2);
        }
    }
}

TEST(Chebyshev, leaves_rows_without_a_diagonal_entry_and_no_rows_at_all_at_zero) {
    const auto comm = Comm::world();
    Smoothed zeros(comm, diagonal(comm, 11, [](Index) { return 0.0; }));
    EXPECT_EQ(zeros.chebyshev.eigenvalue_bound(), 0);
    const auto r = zeros.system.values(noise);
    std::vector<double> z(r.size(), 7.0);
    zeros.chebyshev.start(zeros.level, r, z);
    zeros.chebyshev.improve(zeros.level, r, z);
    EXPECT_EQ(z, std::vector<double>(r.size(), 0.0));
    Smoothed none(comm, diagonal(comm, 0, [](Index) { return 1.0; }));
    EXPECT_EQ(none.chebyshev.eigenvalue_bound(), 0);
}

TEST(ChebyshevMultilevel, is_symmetric_and_positive_with_fixed_rows_and_zero_rows) {
    const auto comm = Comm::world();
    Sample sample(
        comm, chains_with_zeros(comm, 1000),
        [](Index i) {
            return Cell{int(i % 10) / 3, 2 * int(i / 10), 0};
        },
        variant("chebyshev").options);
    for (Index i = sample.system.first; i < sample.system.first + sample.system.rows; ++i) {
        sample.fixed.push_back(i % 7 == 0 ? 1 : 0);
    }
    auto matrix = sample.matrix();
    sample.multilevel.set_up(matrix, {sample.cells, {}, {}, {}, sample.fixed});
    expect_symmetric_and_positive(comm, sample.system, [&](auto r, auto z) { sample.multilevel.apply(r, z); });
    const auto r = sample.system.values(noise);
    std::vector<double> z(r.size(), 3.0);
    sample.multilevel.apply(r, z);
    for (std::size_t i = 0; i < z.size(); ++i) {
        EXPECT_TRUE(std::isfinite(z[i]));
        EXPECT_TRUE(sample.fixed[i] == 0 || z[i] == 0.0);
    }
}

TEST(ChebyshevMultilevel, takes_hardly_more_iterations_than_sweeps_and_the_same_on_any_number_of_ranks) {
    const auto comm = Comm::world();
    for (const Index n : {12, 20}) {
        for (const double residual : {1e-3, 1e-6}) {
            const auto iterations = [&](const Comm& group, const char* smoother, int owners) {
                return poisson_sample(group, n, Border::dirichlet, variant(smoother), owners).iterations(residual);
            };
            const int alone = iterations(Comm::self(), "chebyshev", 1);
            EXPECT_LE(alone, iterations(Comm::self(), "sweeps", 1) + 1);
            for (const int owners : {1, 2, 1 << 20}) EXPECT_NEAR(iterations(comm, "chebyshev", owners), alone, 1);
            RecordProperty(std::to_string(n) + (residual < 1e-4 ? "_to_1e-6" : "_to_1e-3"), alone);
        }
    }
}

TEST(ChebyshevMultilevel, solves_one_row_and_eight_on_more_ranks) {
    const auto comm = Comm::world();
    for (const auto border : {Border::dirichlet, Border::closed}) {
        for (const Index n : {1, 2}) {
            auto chosen = variant("chebyshev");
            chosen.options.max_coarse_size = 1; // coarse levels are smoothed too
            auto sample = poisson_sample(comm, n, border, chosen);
            auto matrix = sample.matrix();
            auto options = sample.krylov();
            if (border == Border::closed) options.null_space = NullSpace::constant;
            KrylovSolver solver(comm, "test", options);
            const auto b = sample.system.product(noise);
            std::vector<double> x(b.size(), 0.0);
            const auto report = solver.solve(matrix, b, x, ConvergenceTest::residual(1e-10));
            EXPECT_TRUE(report.converged()) << report.reason;
            EXPECT_LE(report.iterations, 8);
        }
    }
}

TEST(ChebyshevMultilevel, is_the_default_where_kernels_run_on_several_threads) {
    const bool parallel = Kokkos::DefaultExecutionSpace().concurrency() > 1;
    EXPECT_EQ(MultilevelOptions().smoother, parallel ? Smoother::chebyshev : Smoother::gauss_seidel);
}

} // namespace treacle::solve::chebyshev_test
