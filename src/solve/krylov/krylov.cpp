#include "solve/krylov/krylov.hpp"

#include "base/text/clock.hpp"
#include "base/text/contract.hpp"
#include "base/text/error.hpp"
#include "solve/krylov/petsc_krylov.hpp"
#include "solve/rows/vectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace treacle::solve {

std::string_view to_string(Preconditioner preconditioner) {
    switch (preconditioner) {
    case Preconditioner::none: return "none";
    case Preconditioner::jacobi: return "jacobi";
    case Preconditioner::ic0: return "ic0";
    case Preconditioner::ssor: return "ssor";
    case Preconditioner::sor_jacobi: return "sor_jacobi";
    case Preconditioner::gamg: return "gamg";
    case Preconditioner::boomeramg: return "boomeramg";
    }
    return "";
}

ConvergenceTest ConvergenceTest::residual(double relative, double absolute) {
    ConvergenceTest test;
    test.relative = relative;
    test.absolute = absolute;
    return test;
}

ConvergenceTest ConvergenceTest::measure(
    std::function<double(std::span<const double>)> local, double threshold, double relative) {
    ConvergenceTest test;
    test.local = std::move(local);
    test.threshold = threshold;
    test.relative = relative;
    return test;
}

struct KrylovSolver::State {
    BuiltPreconditioner preconditioner;
    std::vector<double> r, z, p, q;
    std::vector<double> shifted; // the right-hand side for PETSc, with a null space
};

namespace {
// Residuals below this share of the first one are its round-off: beside a guess far larger than the solution no
// smaller one can be had.
constexpr double round_off = 1e-14;
// Directions are begun anew when the residual has fallen to this share of the first, by which round-off may have spoiled
// them, and to half of what it was when they were begun last; before that a breakdown is the matrix's.
constexpr double restart_threshold = 1e-3, min_reduction = 0.5;

// One solve: what its three stages share.
struct Run : Iteration {
    std::span<double> r, z, p, q;
    double mean_b = 0; // with a null space, what is taken off the right-hand side
    double rz = 0;     // r.z
    double first_norm = 0;

    bool begin();
    void iterate();
    void finish();

private:
    void iterate_cg();
    bool renew(double& norm);
    bool breaks_down(double product, Outcome indefinite);
    bool judge(double rr, double measured);
    bool judge_and_precondition(double local_rr, double& new_rz);
};

// The two products of a positive definite pair are positive.
bool Run::breaks_down(double product, Outcome indefinite) {
    if (!std::isfinite(product)) return end(Outcome::non_finite);
    return product <= 0 && end(indefinite);
}

// True when the iteration ends here; every rank has the same numbers and the same result.
bool Run::judge(double rr, double measured) {
    report.error_measure = test.local ? measured : std::sqrt(rr);
    if (!std::isfinite(rr) || !std::isfinite(report.error_measure)) return end(Outcome::non_finite);
    if (passes(std::sqrt(rr), measured)) return end(Outcome::converged);
    if (rr == 0) return end(Outcome::stagnated);
    return false;
}

// r = b - A x, and the first test of it. True when there is nothing to iterate.
bool Run::begin() {
    multiply(x, q);
    if (options.null_space == NullSpace::constant) mean_b = comm.sum(total(b)) / matrix.global_rows();
    const double local_rr = subtract(b, mean_b, q, r);
    std::array<double, 3> sums{local_rr, squares(b, mean_b), measure(r)};
    comm.sum(sums);
    const auto [rr, bb, measured] = sums;
    norm_b = std::sqrt(bb);
    if (!std::isfinite(bb)) return end(Outcome::non_finite);
    if (judge(rr, measured)) return true;
    first_norm = std::sqrt(rr);
    least = std::max(least, round_off * first_norm);
    if (bb == 0 && !test.local) { // the solution is known, and no residual is small against ||b|| = 0
        const bool constant = options.null_space == NullSpace::constant;
        const double level = constant ? comm.sum(total(x)) / matrix.global_rows() : 0.0;
        std::fill(x.begin(), x.end(), level);
        std::fill(r.begin(), r.end(), 0.0);
        report.error_measure = 0;
        return end(Outcome::converged);
    }
    return false;
}

// The test and r.z share one reduction where an application of M too many costs less than a reduction more.
bool Run::judge_and_precondition(double local_rr, double& new_rz) {
    std::array<double, 3> sums{local_rr, measure(r), 0};
    if (preconditioner.is_cheap()) {
        if (!preconditioner.is_identity()) preconditioner.apply(r, z);
        sums[2] = dot(r, z);
        comm.sum(sums);
        new_rz = sums[2];
        return judge(sums[0], sums[1]);
    }
    comm.sum(sums);
    if (judge(sums[0], sums[1])) return true;
    preconditioner.apply(r, z);
    new_rz = comm.sum(dot(r, z));
    return false;
}

// After a breakdown: r = b - A x, from which the recurrence has drifted. True when directions from there may lead on; norm
// is that of the residual when they were begun last.
bool Run::renew(double& norm) {
    multiply(x, q);
    std::array<double, 2> sums{subtract(b, mean_b, q, r), 0};
    sums[1] = measure(r);
    comm.sum(sums);
    const double now = std::sqrt(sums[0]), before = std::exchange(norm, now);
    if (!(now <= restart_threshold * first_norm) || judge(sums[0], sums[1])) return false;
    if (now <= min_reduction * before) return true;
    report.reason = "round-off keeps the residual from falling farther";
    return !end(Outcome::stagnated);
}

void Run::iterate() {
    double norm = first_norm;
    do {
        iterate_cg();
    } while ((report.outcome == Outcome::indefinite_matrix || report.outcome == Outcome::indefinite_preconditioner) &&
             renew(norm));
}

// Preconditioned conjugate gradients (Hestenes and Stiefel 1952; Saad 2003, algorithm 9.1).
void Run::iterate_cg() {
    // z = M r,  p = z
    if (!preconditioner.is_identity()) preconditioner.apply(r, z);
    std::copy(z.begin(), z.end(), p.begin());
    rz = comm.sum(dot(r, z));
    while (report.iterations < options.max_iterations) {
        if (breaks_down(rz, Outcome::indefinite_preconditioner)) return;
        // q = A p
        multiply(p, q);
        const double pq = comm.sum(dot(p, q));
        if (breaks_down(pq, Outcome::indefinite_matrix)) return;
        // alpha = r.z / p.Ap,  x = x + alpha p,  r = r - alpha q
        const double local_rr = step(rz / pq, p, q, x, r);
        ++report.iterations;
        // z = M r
        double new_rz = 0;
        if (judge_and_precondition(local_rr, new_rz)) return;
        // beta = r.z / (r.z before),  p = z + beta p
        turn(new_rz / rz, z, p);
        rz = new_rz;
    }
    end(Outcome::iteration_limit);
}

// The residual of the x that the caller gets: the recurrence for r drifts by round-off.
void Run::finish() {
    if (report.iterations > 0) multiply(x, q);
    const double local_rr = report.iterations > 0 ? subtract(b, mean_b, q, r) : squares(r, 0);
    const double norm_r = std::sqrt(comm.sum(local_rr));
    report.relative_residual = norm_b > 0 ? norm_r / norm_b : norm_r;
    if (report.reason.empty()) report.reason = sentence(report.outcome, options);
}

} // namespace

std::string sentence(Outcome outcome, const KrylovOptions& options) {
    switch (outcome) {
    case Outcome::converged: return "converged";
    case Outcome::iteration_limit:
        return "not converged within " + std::to_string(options.max_iterations) + " iterations";
    case Outcome::indefinite_matrix: return "the matrix is not positive definite (p.Ap <= 0)";
    case Outcome::indefinite_preconditioner: return "the preconditioner is not positive definite (r.Mr <= 0)";
    case Outcome::non_finite: return "the system or an iterate is not finite";
    case Outcome::stagnated: return "the residual is zero and the convergence test still fails";
    case Outcome::preconditioner_failed: return "the preconditioner cannot be set up";
    }
    return "";
}

KrylovSolver::KrylovSolver(const Comm& comm, std::string prefix, KrylovOptions options)
    : comm_(comm), prefix_(std::move(prefix)), options_(std::move(options)), state_(std::make_unique<State>()) {}

KrylovSolver::~KrylovSolver() = default;
KrylovSolver::KrylovSolver(KrylovSolver&&) noexcept = default;
KrylovSolver& KrylovSolver::operator=(KrylovSolver&&) noexcept = default;

SolveReport KrylovSolver::solve(
    Matrix& matrix, std::span<const double> b, std::span<double> x, const ConvergenceTest& test) {
    const auto rows = static_cast<std::size_t>(matrix.rows());
    TREACLE_EXPECT(b.size() == rows && x.size() == rows);
    auto& [preconditioner, r, z, p, q, shifted] = *state_;
    for (auto* vector : {&r, &z, &p, &q}) vector->resize(rows);
    Run run{{comm_, matrix, options_, test, preconditioner, b, x}, r, z, p, q};
    if (matrix.global_rows() == 0) {
        run.report.reason = "no unknowns";
        return run.report;
    }
    const auto start = Clock::now();
    if (!run.begin()) {
        const auto set_up_start = Clock::now();
        const bool ready = preconditioner.set_up(matrix, prefix_, options_);
        run.report.set_up_seconds = seconds_since(set_up_start);
        if (preconditioner.is_identity()) run.z = r;
        if (ready && (options_.method == Method::bicgstab || asks_for_petsc(prefix_))) {
            if (run.mean_b != 0) {
                shifted.assign(b.begin(), b.end());
                for (double& value : shifted) value -= run.mean_b;
                run.b = shifted;
            }
            iterate_with_petsc(run, prefix_);
            run.b = b;
        } else if (ready) {
            run.iterate();
        } else {
            run.report.outcome = Outcome::preconditioner_failed;
        }
    }
    run.finish();
    run.report.iteration_seconds = seconds_since(start) - run.report.set_up_seconds;
    return run.report;
}

void KrylovSolver::set_up(Matrix& matrix) {
    if (state_->preconditioner.set_up(matrix, prefix_, options_)) return;
    throw SimulationError({"solver " + prefix_, "the preconditioner cannot be set up",
        "the matrix is not positive definite or not finite", ""});
}

void KrylovSolver::precondition(std::span<const double> r, std::span<double> z) { state_->preconditioner.apply(r, z); }

void KrylovSolver::release() { state_ = std::make_unique<State>(); }

} // namespace treacle::solve
