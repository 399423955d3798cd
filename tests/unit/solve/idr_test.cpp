#include "fixture.hpp"
#include "solve/krylov/idr.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace treacle::solve::idr_test {
namespace {

constexpr Index unknowns = 60;

// Neither symmetric nor definite: diagonal entries of both signs, unlike in size, and a wind to one side.
TestSystem one_way(const Comm& comm, int owners = 1 << 20) {
    return TestSystem(
        comm, unknowns,
        [](Index i) {
            std::vector<TestSystem::Entry> row;
            if (i > 0) row.push_back({i - 1, -1.5});
            row.push_back({i, (i % 3 == 0 ? -4.0 : 5.0) * (i % 7 == 0 ? 100 : 1)});
            if (i + 1 < unknowns) row.push_back({i + 1, 0.25});
            return row;
        },
        owners);
}

struct Case {
    Comm comm = Comm::world();
    TestSystem system;
    Matrix matrix;
    std::vector<double> weights, b, x;
    Operator all;

    explicit Case(int owners = 1 << 20)
        : system(one_way(comm, owners)), matrix(comm, system.blocks()),
          weights(static_cast<std::size_t>(system.rows), 1.0), b(system.product(noise)), x(b.size(), 0.0) {
        all.multiply = [this](auto from, auto to) { matrix.multiply(from, to); };
        all.precondition = [](auto from, auto to) { std::copy(from.begin(), from.end(), to.begin()); };
        for (std::size_t r = 0; r < weights.size(); ++r) weights[r] = (system.first + Index(r)) % 7 == 0 ? 1e-2 : 1;
        all.weights = weights;
    }
};

TEST(Idr, solves_what_is_neither_symmetric_nor_definite) {
    for (const int owners : {1, 1 << 20}) { // ranks without rows as well
        Case c(owners);
        Idr idr(c.comm, {200, 4});
        const auto report = idr.solve(c.all, c.b, c.x, 1e-10);
        EXPECT_TRUE(report.converged()) << report.reason;
        EXPECT_LE(report.iterations, unknowns + unknowns / 4 + 5); // what is left to round-off
        EXPECT_LT(report.relative_residual, 1.01e-10);
        EXPECT_LT(distance(c.comm, c.x, c.system.values(noise)), 1e-7); // residual times the condition
    }
}

TEST(Idr, takes_fewer_iterations_with_more_shadows_and_no_more_than_rows_with_many) {
    std::vector<int> iterations;
    for (const int shadow_space_dimension : {1, 4, 16, unknowns + 5}) {
        Case c;
        Idr idr(c.comm, {500, shadow_space_dimension});
        const auto report = idr.solve(c.all, c.b, c.x, 1e-8);
        EXPECT_TRUE(report.converged()) << shadow_space_dimension << " " << report.reason;
        iterations.push_back(report.iterations);
    }
    EXPECT_LT(iterations[1], iterations[0]);
    EXPECT_LE(iterations[2], iterations[1]);
    EXPECT_LE(iterations[3], unknowns + 1);
}

TEST(Idr, asks_for_nothing_from_a_guess_that_is_the_solution) {
    Case c;
    c.x = c.system.values(noise);
    Idr idr(c.comm, {});
    EXPECT_EQ(idr.solve(c.all, c.b, c.x, 1e-10).iterations, 0);
}

TEST(Idr, says_that_it_has_not_converged) {
    Case c;
    Idr idr(c.comm, {5, 4});
    const auto report = idr.solve(c.all, c.b, c.x, 1e-12);
    EXPECT_EQ(report.outcome, Outcome::iteration_limit);
    EXPECT_EQ(report.iterations, 5);
    std::vector<double> left(c.b.size());
    c.all.multiply(c.x, left);
    for (std::size_t r = 0; r < left.size(); ++r) left[r] = c.b[r] - left[r];
    EXPECT_DOUBLE_EQ(report.error_measure, idr.norm(c.all, left));
}

TEST(Idr, ends_with_the_best_that_rounding_leaves) {
    Case c;
    for (double& value : c.b) value /= 3; // no x in double precision leaves nothing
    Idr idr(c.comm, {20000, 4});
    const auto report = idr.solve(c.all, c.b, c.x, 1e-19);
    EXPECT_EQ(report.outcome, Outcome::stagnated);
    EXPECT_LT(report.iterations, 1000);
    EXPECT_LT(report.relative_residual, 1e-13);
}

// One shadow comes near a breakdown soon; without new cycles these took 436 iterations on the mean, up to 1256.
TEST(Idr, begins_anew_where_its_recurrences_have_lost_their_accuracy) {
    for (int wave = 1; wave <= 40; ++wave) {
        Case c;
        for (std::size_t r = 0; r < c.b.size(); ++r)
            c.b[r] = std::sin(0.37 * wave * static_cast<double>(c.system.first + Index(r) + 1));
        Idr idr(c.comm, {300, 1});
        const auto report = idr.solve(c.all, c.b, c.x, 1e-13);
        EXPECT_TRUE(report.converged()) << wave << ": " << report.reason;
    }
}

TEST(Idr, says_that_a_system_is_not_finite) {
    Case c;
    if (!c.b.empty()) c.b[0] = std::numeric_limits<double>::quiet_NaN();
    Idr idr(c.comm, {});
    EXPECT_EQ(idr.solve(c.all, c.b, c.x, 1e-10).outcome, Outcome::non_finite);
}

} // namespace
} // namespace treacle::solve::idr_test
