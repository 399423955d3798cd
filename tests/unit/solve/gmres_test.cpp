#include "fixture.hpp"
#include "solve/gmres.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>

namespace treacle::solve {
namespace {

constexpr Index unknowns = 60;

// Neither symmetric nor definite: diagonal entries of both signs, unlike in size, and a wind to one side.
TestSystem one_way(const Comm& comm, int owners = 1 << 20) {
    return TestSystem(comm, unknowns, [](Index i) {
        std::vector<TestSystem::Entry> row;
        if (i > 0) row.push_back({i - 1, -1.5});
        row.push_back({i, (i % 3 == 0 ? -4.0 : 5.0) * (i % 7 == 0 ? 100 : 1)});
        if (i + 1 < unknowns) row.push_back({i + 1, 0.25});
        return row;
    }, owners);
}

struct Case {
    Comm comm = Comm::world();
    TestSystem system;
    Matrix matrix;
    std::vector<double> weights, b, x;
    Operator all;

    explicit Case(int owners = 1 << 20)
        : system(one_way(comm, owners)), matrix(comm, system.blocks()), weights(static_cast<std::size_t>(system.rows), 1.0),
          b(system.product(noise)), x(b.size(), 0.0) {
        all.multiply = [this](auto from, auto to) { matrix.multiply(from, to); };
        all.precondition = [](auto from, auto to) { std::copy(from.begin(), from.end(), to.begin()); };
        for (std::size_t r = 0; r < weights.size(); ++r) weights[r] = (system.first + Index(r)) % 7 == 0 ? 1e-2 : 1;
        all.weights = weights;
    }
};

TEST(Gmres, solves_what_is_neither_symmetric_nor_definite) {
    for (const int owners : {1, 1 << 20}) { // ranks without rows as well
        Case c(owners);
        Gmres gmres(c.comm, {200, 100});
        const auto report = gmres.solve(c.all, c.b, c.x, 1e-10);
        EXPECT_TRUE(report.converged()) << report.reason;
        EXPECT_LE(report.iterations, unknowns);
        EXPECT_LT(report.relative_residual, 1.01e-10);
        EXPECT_LT(distance(c.comm, c.x, c.system.values(noise)), 1e-7); // residual times the condition
    }
}

TEST(Gmres, goes_on_after_restarts) {
    Case c;
    Gmres gmres(c.comm, {500, 12});
    const auto report = gmres.solve(c.all, c.b, c.x, 1e-10);
    EXPECT_TRUE(report.converged()) << report.reason;
    EXPECT_GT(report.iterations, 12);
    EXPECT_LT(distance(c.comm, c.x, c.system.values(noise)), 1e-7);
}

TEST(Gmres, asks_for_nothing_from_a_guess_that_is_the_solution) {
    Case c;
    c.x = c.system.values(noise);
    Gmres gmres(c.comm, {});
    EXPECT_EQ(gmres.solve(c.all, c.b, c.x, 1e-10).iterations, 0);
}

TEST(Gmres, says_that_it_has_not_converged_and_leaves_its_best) {
    Case c;
    Gmres gmres(c.comm, {5, 40});
    const double before = gmres.norm(c.all, c.b);
    const auto report = gmres.solve(c.all, c.b, c.x, 1e-12);
    EXPECT_EQ(report.outcome, Outcome::iteration_limit);
    EXPECT_EQ(report.iterations, 5);
    EXPECT_LT(report.error_measure, before);
}

TEST(Gmres, says_that_a_system_is_not_finite) {
    Case c;
    if (!c.b.empty()) c.b[0] = std::numeric_limits<double>::quiet_NaN();
    Gmres gmres(c.comm, {});
    EXPECT_EQ(gmres.solve(c.all, c.b, c.x, 1e-10).outcome, Outcome::non_finite);
}

} // namespace
} // namespace treacle::solve
