#include "base/text/error.hpp"
#include "fixture.hpp"
#include "solve/krylov/krylov.hpp"
#include "solve/rows/petsc.hpp"
#include "solve/rows/runtime.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace treacle::solve::runtime_test {

TEST(SolveRuntime, names_its_libraries) {
    EXPECT_EQ(petsc_version().substr(0, 2), "3.");
    EXPECT_EQ(hypre_version().substr(0, 2), "2.");
}

TEST(SolveRuntime, refuses_a_word_where_an_option_is_expected) {
    EXPECT_THROW(SolveRuntime("pressure_pc_type sor"), InputError);
}

TEST(SolveRuntime, an_error_inside_petsc_becomes_an_exception_with_its_text) {
    try {
        check(PetscError(PETSC_COMM_SELF, 7, "f", "file.c", PETSC_ERR_ARG_WRONG, PETSC_ERROR_INITIAL, "no way"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::simulation_failed);
        EXPECT_NE(std::string(error.what()).find("no way"), std::string::npos) << error.what();
    }
}

TEST(SolveRuntime, lack_of_memory_inside_petsc_has_its_own_exit_code) {
    try {
        check(PetscError(PETSC_COMM_SELF, 7, "f", "file.c", PETSC_ERR_MEM, PETSC_ERROR_INITIAL, "asked 9"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::out_of_memory);
    }
}

namespace {

// z = M r for r = 1 after a solve with 6 on the diagonal, on a rank that has rows.
double first_of_preconditioned(const std::string& prefix) {
    const auto comm = Comm::world();
    auto system = poisson(comm, 8, Border::dirichlet);
    Matrix matrix(comm, system.blocks());
    KrylovOptions options;
    options.preconditioner = Preconditioner::none;
    KrylovSolver solver(comm, prefix, options);
    solver.set_up(matrix);
    const auto ones = system.values([](Index) { return 1.0; });
    std::vector<double> z(ones.size());
    solver.precondition(ones, z);
    return z.at(0);
}

} // namespace

TEST(PrefixedOptions, win_over_the_callers_choice) {
    EXPECT_DOUBLE_EQ(first_of_preconditioned("plain"), 1.0);
    EXPECT_DOUBLE_EQ(first_of_preconditioned("chosen"), 1.0 / 6);
}

TEST(PrefixedOptions, with_an_unknown_value_are_an_input_error_naming_it) {
    try {
        first_of_preconditioned("bad");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("nonsense"), std::string::npos) << error.what();
    }
}

TEST(PrefixedOptions, eisenstat_is_refused_since_it_needs_petscs_own_krylov_methods) {
    EXPECT_THROW(first_of_preconditioned("sweeping"), InputError);
}

namespace {
SolveReport solved(const std::string& prefix, const ConvergenceTest& test, Preconditioner preconditioner,
    Border border = Border::dirichlet) {
    const auto comm = Comm::world();
    auto system = poisson(comm, 12, border);
    Matrix matrix(comm, system.blocks());
    KrylovOptions options;
    options.preconditioner = preconditioner;
    if (border == Border::closed) options.null_space = NullSpace::constant;
    KrylovSolver solver(comm, prefix, options);
    auto b = system.product(noise);
    for (double& value : b) value += border == Border::closed ? 0.25 : 0;
    std::vector<double> x(b.size(), 1.0);
    return solver.solve(matrix, b, x, test);
}
const auto tight = ConvergenceTest::residual(1e-9);
} // namespace

TEST(PrefixedOptions, have_petscs_krylov_methods_solve_with_our_preconditioner_and_test) {
    for (const auto preconditioner : {Preconditioner::none, Preconditioner::ic0, Preconditioner::jacobi}) {
        for (const Border border : {Border::dirichlet, Border::closed}) {
            const auto ours = solved("plain", tight, preconditioner, border);
            const auto theirs = solved("same", tight, preconditioner, border);
            EXPECT_TRUE(theirs.converged()) << theirs.reason;
            EXPECT_LE(theirs.relative_residual, 1.01e-9);       // the recurrence's drift
            EXPECT_NEAR(theirs.iterations, ours.iterations, 1); // the same method, other sums
            const auto other = solved("minimal", tight, preconditioner, border);
            EXPECT_TRUE(other.converged()) << other.reason;
            EXPECT_LE(other.relative_residual, 1.01e-9);
        }
    }
    const auto unused = runtime().unused_options();
    EXPECT_EQ(std::count(unused.begin(), unused.end(), "-minimal_ksp_type minres"), 0);
}

TEST(PrefixedOptions, leave_the_callers_measure_in_charge) {
    const auto negative = [](std::span<const double> r) {
        double sum = 0;
        for (const double value : r) sum += std::max(0.0, -value);
        return sum;
    };
    const auto test = ConvergenceTest::measure(negative, 1e-3);
    const auto ours = solved("plain", test, Preconditioner::ic0), theirs = solved("same", test, Preconditioner::ic0);
    EXPECT_TRUE(theirs.converged());
    EXPECT_NEAR(theirs.iterations, ours.iterations, 1);
    EXPECT_LT(theirs.error_measure, 1e-3);
}

TEST(PrefixedOptions, bound_the_iterations_and_loosen_the_tolerance) {
    const auto limited = solved("limited", tight, Preconditioner::jacobi);
    EXPECT_EQ(limited.outcome, Outcome::iteration_limit);
    EXPECT_EQ(limited.iterations, 3);
    const auto loose = solved("loose", tight, Preconditioner::jacobi);
    EXPECT_TRUE(loose.converged());
    EXPECT_LE(loose.relative_residual, 1e-2);
    EXPECT_GT(loose.relative_residual, 1e-4);
}

TEST(PrefixedOptions, with_an_unknown_krylov_method_are_an_input_error_naming_it) {
    try {
        solved("odd", tight, Preconditioner::jacobi);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("strange"), std::string::npos) << error.what();
    }
}

TEST(PrefixedOptions, that_nothing_has_asked_for_are_listed) {
    first_of_preconditioned("chosen");
    const auto unused = runtime().unused_options();
    const auto has = [&](const char* text) { return std::count(unused.begin(), unused.end(), text); };
    EXPECT_EQ(has("-misspelt_pc_tipe jacobi"), 1);
    EXPECT_EQ(has("-chosen_pc_type jacobi"), 0);
}

} // namespace treacle::solve::runtime_test
