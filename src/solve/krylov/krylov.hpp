#pragma once
#include "mpi/comm.hpp"
#include "solve/rows/matrix.hpp"

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace treacle::solve {

// Preconditioners that are built from the stored entries of a matrix.
enum class Preconditioner {
    none,
    jacobi,
    ic0,        // incomplete Cholesky without fill of each rank's block, shifted where it would break down
    ssor,       // one symmetric sweep of over-relaxation in each rank's block
    sor_jacobi, // two sweeps of relaxation with all rows at once: z = omega D^-1 (2 - omega A D^-1) r
    gamg,       // PETSc's smoothed aggregation, Chebyshev–Jacobi smoother
    boomeramg,  // HYPRE: HMIS, ext+i, at most 4 entries a row of P, one aggressive level, l1 smoother
};
// "ic0"; the words of scene files.
std::string_view to_string(Preconditioner preconditioner);

// Krylov method of a solve.
enum class Method {
    conjugate_gradients,
    bicgstab // PETSc's, for matrices that are not symmetric
};

// A preconditioner of the caller's own.
struct UserPreconditioner {
    // z = M r on this rank's rows; collective if the caller's is. M must be symmetric and positive definite.
    std::function<void(std::span<const double> r, std::span<double> z)> apply;
    // Collective: called before the first apply for a matrix, and again when its values have changed. May be empty.
    std::function<void(Matrix&)> set_up;
    explicit operator bool() const { return static_cast<bool>(apply); }
};

// Null space of the matrix; preconditioned residuals are projected off it too.
enum class NullSpace {
    none,
    constant, // A 1 = 0: the right-hand side is projected onto the range, the mean of x stays that of the
              // guess
};

// Settings of a KrylovSolver, fixed at its construction.
struct KrylovOptions {
    Method method = Method::conjugate_gradients; // bicgstab is left to PETSc
    Preconditioner preconditioner = Preconditioner::ic0;
    int max_iterations = 1000; // reached: Outcome::iteration_limit
    NullSpace null_space = NullSpace::none;
    // boomeramg: couplings above this share of the row's strongest one; 0.5 in 3D, 0.25 in 2D.
    double strong_threshold = 0.5;
    double relaxation = 1; // omega of ssor, below 2, and of sor_jacobi, positive for omega < 2 / lambda_max(D^-1 A)
    int sweeps = 1;        // of ssor
    // Takes the place of preconditioner when set.
    UserPreconditioner user;
};

// Stopping test, evaluated on the residual r = b - A x of every iteration, before the first one too.
struct ConvergenceTest {
    // ||r|| <= max(relative ||b||, absolute), norms without the preconditioner.
    static ConvergenceTest residual(double relative, double absolute = 0);
    // Sum over the ranks of local(r of this rank's rows) < threshold; local must not throw nor communicate.
    // And ||r|| <= relative ||b||.
    // Average density error, dissertation 2.5.1: local = sum max(0, -r_i) dt^2 / (N rho_0), threshold = eta.
    static ConvergenceTest measure(
        std::function<double(std::span<const double>)> local, double threshold, double relative = unbounded);

    // Value of `relative` with which ||r|| is not tested.
    static constexpr double unbounded = std::numeric_limits<double>::infinity();

    double relative = 0; // [1] of ||b||
    double absolute = 0; // unit of b
    // Part of this rank; empty: the residual alone is tested.
    std::function<double(std::span<const double>)> local;
    double threshold = 0; // unit of local's sum
};

// End of a solve.
enum class Outcome {
    converged,                 // the test has passed
    iteration_limit,           // max_iterations without the test having passed
    indefinite_matrix,         // p.Ap <= 0
    indefinite_preconditioner, // r.Mr <= 0
    non_finite,                // a residual, product or measure is infinite or no number
    stagnated, // the residual is zero and the user's measure still above its threshold, or round-off holds it up
    preconditioner_failed, // cannot be set up
};

// Result of a solve, successful or not.
struct SolveReport {
    Outcome outcome = Outcome::converged;
    bool converged() const { return outcome == Outcome::converged; }
    std::string reason;           // a sentence for the user
    int iterations = 0;           // 0 where the guess passed the test
    double relative_residual = 0; // ||b - A x|| / ||b||, computed anew from the returned x; ||b - A x|| if b = 0
    double error_measure = 0;     // what the test compared last: ||r||, or the sum of the user's measure
    std::int64_t products = 0;    // matrix-vector products, the final check included, smoothers not
    double set_up_seconds = 0;    // of the preconditioner
    double iteration_seconds = 0; // all the rest
};

// Conjugate gradients for symmetric positive (semi)definite matrices, or BiCGStab, on the caller's arrays. Work vectors
// are kept between solves. Options of PETSc are read under the prefix and override KrylovOptions: with "pressure",
// -pressure_pc_type, -pressure_sub_pc_factor_levels, -pressure_pc_hypre_… for the preconditioner; -pressure_ksp_type,
// -pressure_ksp_max_it, -pressure_ksp_rtol, -pressure_ksp_monitor … have the solve done by PETSc's Krylov methods, with
// the same preconditioner and test.
class KrylovSolver {
public:
    KrylovSolver(const Comm& comm, std::string prefix, KrylovOptions options);
    ~KrylovSolver();
    KrylovSolver(KrylovSolver&&) noexcept;
    KrylovSolver& operator=(KrylovSolver&&) noexcept;

    // Solves A x = b from the guess in x. Collective; the report is the same on every rank, its seconds
    // aside. An unsuccessful solve is a report, not an exception, with x the last iterate. When the guess
    // passes the test, nothing is set up. Throws what PETSc throws (runtime.hpp).
    SolveReport solve(Matrix& matrix, std::span<const double> b, std::span<double> x, const ConvergenceTest& test);

    // The preconditioner by itself: set_up, then any number of z = M r. Collective. solve() calls set_up and
    // keeps the result for further solves with the same Matrix. SimulationError when it cannot be made.
    void set_up(Matrix& matrix);
    void precondition(std::span<const double> r, std::span<double> z);

    // Gives back what solves leave for the next one: work vectors and the preconditioner of the last matrix.
    void release();

    // As given to the constructor; PETSc's options, which win over them, are not among them.
    const KrylovOptions& options() const { return options_; }

private:
    struct State;
    Comm comm_;
    std::string prefix_;
    KrylovOptions options_;
    std::unique_ptr<State> state_;
};

} // namespace treacle::solve
