#include "fixture.hpp"
#include "solve/krylov/complementarity.hpp"
#include "solve/krylov/field_split_preconditioner.hpp"
#include "solve/krylov/idr.hpp"
#include "solve/multigrid/multilevel.hpp"
#include "solve/multigrid/rigid_multilevel.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

// Systems without rows, and the next ones that have some: liquid comes and goes in a run.
namespace treacle::solve::empty_test {

namespace {
const std::vector<Preconditioner> kinds{Preconditioner::none, Preconditioner::jacobi, Preconditioner::ic0,
    Preconditioner::ssor, Preconditioner::sor_jacobi, Preconditioner::gamg, Preconditioner::boomeramg};

// Cells of the rows of poisson(n), two wide.
std::vector<int> cells_of(const TestSystem& system, Index n) {
    std::vector<int> cells;
    for (Index i = system.first; i < system.first + system.rows; ++i) {
        for (const Index c : {i % n, i / n % n, i / (n * n)}) cells.push_back(c / 2);
    }
    return cells;
}

class EmptySystems : public testing::Test {
protected:
    const Comm comm = Comm::world();
    static constexpr Index width = 6;

    // A solver that has seen rows, then none, then rows again gives what a new one does.
    void expect_to_serve(
        KrylovSolver& solver, const std::function<void(TestSystem&)>& before = [](TestSystem&) {}) {
        for (const Index n : {Index{0}, width, Index{0}, width}) {
            auto system = poisson(comm, n, Border::dirichlet);
            before(system);
            Matrix matrix(comm, system.blocks());
            const auto b = system.product(noise);
            std::vector<double> x(b.size(), 0.0), z(b.size(), 0.0);
            solver.set_up(matrix);
            solver.precondition(b, z);
            const auto report = solver.solve(matrix, b, x, ConvergenceTest::residual(1e-10));
            EXPECT_TRUE(report.converged()) << n << ": " << report.reason;
            EXPECT_EQ(report.iterations > 0, n > 0);
            const auto exact = system.values(noise);
            EXPECT_LE(distance(comm, x, exact), 1e-7) << n; // 1e-10 ||b|| over the least eigenvalue
        }
    }
};
} // namespace

TEST_F(EmptySystems, need_no_preconditioner_of_any_kind) {
    for (const auto kind : kinds) {
        KrylovOptions options;
        options.preconditioner = kind;
        KrylovSolver solver(comm, "test", options);
        expect_to_serve(solver);
    }
}

TEST_F(EmptySystems, need_no_hierarchy_of_the_callers) {
    Multilevel multilevel(comm, {});
    std::vector<int> cells;
    KrylovOptions options;
    options.user.set_up = [&](Matrix& matrix) {
        multilevel.set_up(matrix, {.cells = cells, .dirichlet = {}, .walls = {}});
    };
    options.user.apply = [&](auto r, auto z) { multilevel.apply(r, z); };
    KrylovSolver solver(comm, "test", options);
    expect_to_serve(solver, [&](TestSystem& system) { cells = cells_of(system, width); });
}

TEST_F(EmptySystems, leave_hierarchies_as_good_as_new) {
    Multilevel multilevel(comm, {});
    RigidMultilevel rigid(comm, {});
    for (const Index n : {Index{0}, width, Index{0}, width}) {
        auto system = poisson(comm, n, Border::dirichlet);
        Matrix matrix(comm, system.blocks());
        const auto cells = cells_of(system, width);
        multilevel.set_up(matrix, {.cells = cells, .dirichlet = {}, .walls = {}});
        const std::vector<double> positions(cells.begin(), cells.end());
        const std::vector<signed char> axes(static_cast<std::size_t>(system.rows), 0);
        rigid.set_up(matrix, {3, 1.0, cells, positions, axes, {}});
        const auto r = system.values(noise);
        std::vector<double> z(r.size(), 0.0);
        multilevel.apply(r, z);
        rigid.apply(r, z);
        if (n == 0) continue;
        expect_symmetric_and_positive(comm, system, [&](auto from, auto to) { multilevel.apply(from, to); });
        expect_symmetric_and_positive(comm, system, [&](auto from, auto to) { rigid.apply(from, to); });
    }
}

// A rank beside the liquid has none of its rows, and cells of it in its halo.
TEST_F(EmptySystems, of_some_ranks_take_part_in_all_exchanges) {
    auto system = poisson(comm, width, Border::dirichlet, std::max(1, comm.size() - 1));
    if (system.rows == 0)
        system.halo.connect(comm, system.first, std::vector<Index>{0, system.global_rows - 1});
    else
        system.halo.connect(
            comm, system.first, std::vector<Index>(system.halo.columns().begin(), system.halo.columns().end()));
    Matrix matrix(comm, system.blocks());
    const auto cells = cells_of(system, width);
    const std::vector<double> positions(cells.begin(), cells.end());
    const std::vector<signed char> axes(static_cast<std::size_t>(system.rows), 0);
    Multilevel multilevel(comm, {.max_coarse_size = 10});
    multilevel.set_up(matrix, {.cells = cells, .dirichlet = {}, .walls = {}});
    expect_symmetric_and_positive(comm, system, [&](auto from, auto to) { multilevel.apply(from, to); });
    RigidMultilevel rigid(comm, {.max_coarse_size = 10});
    rigid.set_up(matrix, {3, 1.0, cells, positions, axes, {}});
    expect_symmetric_and_positive(comm, system, [&](auto from, auto to) { rigid.apply(from, to); });
}

TEST_F(EmptySystems, may_be_one_component_of_several) {
    for (const auto kind : kinds) {
        FieldSplitPreconditioner split(comm, "test", kind);
        auto system = poisson(comm, width, Border::dirichlet);
        Matrix matrix(comm, system.blocks());
        const std::vector<signed char> second(static_cast<std::size_t>(system.rows), 1);
        split.set_up(matrix, second, 3);
        expect_symmetric_and_positive(comm, system, [&](auto r, auto z) { split.apply(r, z); });
    }
}

TEST_F(EmptySystems, have_nothing_to_complement) {
    ComplementaritySolver solver(comm, "test", {});
    for (const Index n : {Index{0}, width, Index{0}}) {
        auto system = poisson(comm, n, Border::dirichlet);
        Matrix matrix(comm, system.blocks());
        const auto b = system.values([](Index) { return 1.0; });
        std::vector<double> x(b.size(), 0.0);
        std::vector<RowState> states(b.size(), RowState::free);
        const auto report = solver.solve(matrix, b, x, states, ConvergenceTest::residual(1e-8));
        EXPECT_TRUE(report.solve.converged()) << report.solve.reason;
    }
}

TEST_F(EmptySystems, are_solved_by_induced_dimension_reduction) {
    Idr idr(comm, {});
    const Operator nothing{[](auto, auto) {}, [](auto, auto) {}, {}};
    std::vector<double> x;
    const auto report = idr.solve(nothing, {}, x, 1e-8);
    EXPECT_TRUE(report.converged()) << report.reason;
    EXPECT_EQ(report.iterations, 0);
}

TEST_F(EmptySystems, are_not_mistaken_for_preconditioners_that_were_never_set_up) {
    KrylovSolver solver(comm, "test", {});
    std::vector<double> z(1);
    EXPECT_THROW(solver.precondition(z, z), std::logic_error);
}

} // namespace treacle::solve::empty_test
