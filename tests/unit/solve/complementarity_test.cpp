#include "fixture.hpp"
#include "solve/krylov/complementarity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace treacle::solve::complementarity_test {
namespace {

constexpr Index n = 12;

// A ring of springs of different strength, some rows of which are held to the ground.
double strength(Index i) { return 1.5 + noise(100 + i % n); }
double ground(Index i) { return i % 4 == 1 ? 0.3 + 0.2 * noise(200 + i) : 0.0; }

TestSystem ring(const Comm& comm, bool grounded) {
    return {comm, n, [grounded](Index i) {
                const Index before = (i + n - 1) % n, after = (i + 1) % n;
                std::vector<TestSystem::Entry> row{{before, -strength(before)},
                    {i, strength(before) + strength(i) + (grounded ? ground(i) : 0)}, {after, -strength(i)}};
                std::sort(row.begin(), row.end());
                return row;
            }};
}

// Gaussian elimination on the rows of a set; the others' values are 0.
std::vector<double> solve_on(
    const std::vector<std::vector<double>>& matrix, const std::vector<double>& b, unsigned set) {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < b.size(); ++i) {
        if ((set >> i & 1u) != 0) rows.push_back(i);
    }
    std::vector<std::vector<double>> a;
    for (const auto i : rows) {
        a.emplace_back();
        for (const auto j : rows) a.back().push_back(matrix[i][j]);
        a.back().push_back(b[i]);
    }
    const std::size_t m = rows.size();
    for (std::size_t k = 0; k < m; ++k) {
        for (std::size_t i = k + 1; i < m; ++i) {
            const double factor = a[i][k] / a[k][k];
            for (std::size_t j = k; j <= m; ++j) a[i][j] -= factor * a[k][j];
        }
    }
    std::vector<double> x(b.size(), 0.0);
    for (std::size_t k = m; k-- > 0;) {
        double sum = a[k][m];
        for (std::size_t j = k + 1; j < m; ++j) sum -= a[k][j] * x[rows[j]];
        x[rows[k]] = sum / a[k][k];
    }
    return x;
}

// The solution by testing every set of rows.
std::vector<double> search(const std::vector<std::vector<double>>& matrix, const std::vector<double>& b) {
    for (unsigned set = 0; set < 1u << b.size(); ++set) {
        const auto x = solve_on(matrix, b, set);
        bool good = true;
        for (std::size_t i = 0; i < b.size() && good; ++i) {
            double gradient = -b[i];
            for (std::size_t j = 0; j < b.size(); ++j) gradient += matrix[i][j] * x[j];
            good = x[i] >= 0 && gradient >= -1e-12;
        }
        if (good) return x;
    }
    ADD_FAILURE() << "no set solves the problem";
    return {};
}

std::vector<std::vector<double>> dense(const TestSystem& system) {
    std::vector<std::vector<double>> out(std::size_t(n), std::vector<double>(std::size_t(n), 0.0));
    for (Index i = 0; i < n; ++i) {
        for (const auto& [column, value] : system.row(i)) out[std::size_t(i)][std::size_t(column)] = value;
    }
    return out;
}

KrylovOptions with(Preconditioner preconditioner) {
    KrylovOptions options;
    options.preconditioner = preconditioner;
    options.max_iterations = 500;
    return options;
}

class EachCut : public testing::TestWithParam<Preconditioner> {
protected:
    void SetUp() override { runtime(); }
    const Comm comm = Comm::world();
};
INSTANTIATE_TEST_SUITE_P(all, EachCut,
    testing::Values(Preconditioner::none, Preconditioner::jacobi, Preconditioner::ic0, Preconditioner::ssor),
    [](const auto& info) { return std::string(to_string(info.param)); });

} // namespace

TEST_P(EachCut, finds_what_trying_every_set_of_rows_finds) {
    auto system = ring(comm, true);
    int pressed = 0;
    for (Index sample = 0; sample < 20; ++sample) {
        const auto b = [&](Index i) { return noise(1000 * (sample + 1) + i) - 0.2; };
        std::vector<double> all;
        for (Index i = 0; i < n; ++i) all.push_back(b(i));
        const auto wanted = search(dense(system), all);
        pressed += static_cast<int>(std::count_if(wanted.begin(), wanted.end(), [](double x) { return x > 0; }));
        // From the worst first set, and from all rows.
        for (const auto first : {RowState::bound, RowState::free}) {
            Matrix matrix(comm, system.blocks());
            ComplementaritySolver solver(comm, "test", with(GetParam()));
            auto x = system.values([&](Index i) { return std::abs(noise(i)); });
            const auto right = system.values(b);
            std::vector<RowState> states(x.size(), first);
            const auto report = solver.solve(matrix, right, x, states, ConvergenceTest::residual(0, 1e-12));
            ASSERT_TRUE(report.solve.converged()) << report.solve.reason;
            for (std::size_t i = 0; i < x.size(); ++i) {
                // The residual times the inverse's norm, of about 10.
                EXPECT_NEAR(x[i], wanted[std::size_t(system.first) + i], 1e-10);
                EXPECT_EQ(states[i] == RowState::free, x[i] > 0);
            }
            EXPECT_LT(report.solve.iterations, 60);
            system = ring(comm, true); // the matrix changed the column numbers
        }
    }
    EXPECT_GT(pressed, 40);
    EXPECT_LT(pressed, 200);
}

TEST_P(EachCut, fixed_rows_stay_zero_and_do_not_count) {
    auto system = ring(comm, true);
    Matrix matrix(comm, system.blocks());
    ComplementaritySolver solver(comm, "test", with(GetParam()));
    const auto right = system.values([](Index) { return 1.0; });
    auto x = system.values([](Index) { return 1.0; });
    std::vector<RowState> states(x.size(), RowState::free);
    for (std::size_t i = 0; i < x.size(); ++i) {
        if ((system.first + Index(i)) % 3 == 0) states[i] = RowState::fixed;
    }
    const auto report = solver.solve(matrix, right, x, states, ConvergenceTest::residual(0, 1e-12));
    ASSERT_TRUE(report.solve.converged()) << report.solve.reason;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const bool fixed = (system.first + Index(i)) % 3 == 0;
        EXPECT_EQ(states[i] == RowState::fixed, fixed);
        if (fixed) {
            EXPECT_EQ(x[i], 0);
            EXPECT_LT(solver.gradient()[i], 0); // it would rise
        } else {
            EXPECT_GT(x[i], 0);
        }
    }
}

TEST(Complementarity, a_problem_without_a_solution_is_reported) {
    runtime();
    const auto comm = Comm::world();
    auto system = ring(comm, false);
    Matrix matrix(comm, system.blocks());
    ComplementaritySolver solver(comm, "test", with(Preconditioner::jacobi));
    const auto right = system.values([](Index i) { return i == 0 ? 3.0 : -0.1; }); // nothing holds what presses
    auto x = system.values([](Index) { return 0.0; });
    std::vector<RowState> states(x.size(), RowState::free);
    const auto report = solver.solve(matrix, right, x, states, ConvergenceTest::residual(0, 1e-12));
    EXPECT_FALSE(report.solve.converged());
}

TEST(Complementarity, a_singular_matrix_has_a_solution_where_the_set_leaves_a_row) {
    runtime();
    const auto comm = Comm::world();
    auto system = ring(comm, false);
    Matrix matrix(comm, system.blocks());
    ComplementaritySolver solver(comm, "test", with(Preconditioner::jacobi));
    const auto b = [](Index i) { return i == 0 ? 1.0 : -0.5; };
    auto x = system.values([](Index) { return 0.0; });
    std::vector<RowState> states(x.size(), RowState::bound);
    const auto right = system.values(b);
    const auto report = solver.solve(matrix, right, x, states, ConvergenceTest::residual(0, 1e-12));
    ASSERT_TRUE(report.solve.converged()) << report.solve.reason;
    std::vector<double> all;
    for (Index i = 0; i < n; ++i) all.push_back(b(i));
    const auto wanted = search(dense(system), all);
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], wanted[std::size_t(system.first) + i], 1e-10);
}

} // namespace treacle::solve::complementarity_test
