#include "sph/iisph/bounded_solve.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace treacle::sph {

namespace {
struct Watch {
    Array<double> watched;
    KOKKOS_INLINE_FUNCTION double operator()(int i) const { return watched.size() > 0 ? watched(i) : 1.0; }
};

// The residual -g of a row counts where q > 0, and where it would raise q.
KOKKOS_INLINE_FUNCTION bool counts(double q, double g) { return q > 0 || g < 0; }

KOKKOS_INLINE_FUNCTION void add_residual(
    double q, double g, double watched, double& excess, double& count, double& square) {
    if (!counts(q, g)) return;
    excess += math::max(0.0, -g);
    count += 1;
    square += watched * g * g;
}

// Multiplies q and A q by what makes q.Aq/2 - b.q least.
void scale_to_least(const Comm& comm, const BoundedProblem& problem) {
    const int rows = problem.rows;
    const auto &q = problem.q, &product = problem.product, &b = problem.right_hand_side;
    std::array<double, 2> dots{};
    Kokkos::parallel_reduce(
        "treacle::bounded_multiple", rows,
        KOKKOS_LAMBDA(int i, double& along, double& curvature) {
            along += b(i) * q(i);
            curvature += product(i) * q(i);
        },
        dots[0], dots[1]);
    if (rows == 0) dots = {};
    comm.sum(std::span(dots));
    const double length = dots[1] > 0 ? std::max(0.0, dots[0] / dots[1]) : 0;
    Kokkos::parallel_for(
        "treacle::bounded_scale", rows, KOKKOS_LAMBDA(int i) {
            q(i) *= length;
            product(i) *= length;
        });
}

// Product of the guess. Returns how many products that took.
int multiply_guess(const Comm& comm, const BoundedProblem& problem) {
    if (problem.guess == BoundedGuess::zero) {
        Kokkos::deep_copy(problem.product, 0.0);
        return 0;
    }
    problem.multiply(problem.q);
    if (problem.guess == BoundedGuess::best_multiple) scale_to_least(comm, problem);
    return 1;
}

// True when iterating ends, with the outcome in the report.
bool ended(const StoppingTest& goal, BoundedReport& report) {
    auto& out = report.solve;
    if (!std::isfinite(report.residual.square + report.residual.excess)) {
        out.outcome = solve::Outcome::non_finite;
        out.reason = "the residual is not a finite number";
    } else if (out.iterations >= goal.least_iterations && goal.met(report.residual)) {
        out.outcome = solve::Outcome::converged;
    } else if (out.iterations >= goal.max_iterations) {
        out.outcome = solve::Outcome::iteration_limit;
        out.reason = "the iteration limit was reached";
    } else {
        return false;
    }
    return true;
}

// This rank's part of watched_square().
double own_square(const BoundedProblem& problem, const Array<double>& gradient) {
    const auto& q = problem.q;
    const int rows = problem.rows;
    const Watch watch{problem.watched};
    const RowGroups groups = problem.groups;
    double square = 0;
    const int terms = groups.apply ? groups.count : rows;
    Kokkos::parallel_reduce(
        "treacle::watched_square", terms,
        KOKKOS_LAMBDA(int k, double& sum) {
            const int first = groups.apply ? groups.begin(k) : k;
            const int last = math::min(rows, groups.apply ? groups.end(k) : k + 1);
            double own = 0;
            for (int i = first; i < last; ++i) own += counts(q(i), gradient(i)) ? watch(i) * gradient(i) : 0;
            sum += own * own;
        },
        square);
    return terms > 0 ? square : 0.0;
}

// Products of the last change s of q and the change y of the gradient that it made: s.Ds, s.y, y.y/D.
struct Curvature {
    double change = 0, across = 0, gradient = 0;
};

struct Standing {
    BoundedResidual residual;
    Curvature last;
};

// gradient <- A q - b from the product; rows without a diagonal get 0.
Standing take_gradient(
    const Comm& comm, const BoundedProblem& problem, const Array<double>& gradient, const Array<double>& change) {
    const auto &q = problem.q, &product = problem.product, &b = problem.right_hand_side, &diagonal = problem.diagonal;
    const Watch watch{problem.watched};
    std::array<double, 6> s{};
    Kokkos::parallel_reduce(
        "treacle::bounded_gradient", problem.rows,
        KOKKOS_LAMBDA(int i, double& excess, double& count, double& square, double& ss, double& sy, double& yy) {
            const double d = diagonal(i);
            const double g = d > 0 ? product(i) - b(i) : 0;
            const double y = g - gradient(i);
            gradient(i) = g;
            ss += change(i) * d * change(i);
            sy += change(i) * y;
            if (d > 0 && counts(q(i), g)) yy += y * y / d;
            add_residual(q(i), g, watch(i), excess, count, square);
        },
        s[0], s[1], s[2], s[3], s[4], s[5]);
    if (problem.rows == 0) s = {};
    if (problem.groups.apply) s[2] = own_square(problem, gradient);
    comm.sum(std::span(s));
    return {{s[0], s[1], s[2]}, {s[3], s[4], s[5]}};
}

void step_down(
    const BoundedProblem& problem, double alpha, const Array<double>& gradient, const Array<double>& change) {
    const auto &q = problem.q, &diagonal = problem.diagonal;
    Kokkos::parallel_for(
        "treacle::bounded_step", problem.rows, KOKKOS_LAMBDA(int i) {
            const double d = diagonal(i);
            const double next = d > 0 ? math::max(0.0, q(i) - alpha * gradient(i) / d) : 0;
            change(i) = next - q(i);
            q(i) = next;
        });
}
} // namespace

double watched_square(const Comm& comm, const BoundedProblem& problem, const Array<double>& gradient) {
    return comm.sum(own_square(problem, gradient));
}

BoundedReport bounded_jacobi(const Comm& comm, const BoundedProblem& problem, double omega, const StoppingTest& goal) {
    BoundedReport report;
    const auto &q = problem.q, &product = problem.product, &b = problem.right_hand_side;
    const auto& diagonal = problem.diagonal;
    const Watch watch{problem.watched};
    report.solve.products = multiply_guess(comm, problem);
    do {
        if (report.solve.iterations > 0) {
            problem.multiply(q);
            ++report.solve.products;
        }
        std::array<double, 3> s{};
        Kokkos::parallel_reduce(
            "treacle::bounded_jacobi", problem.rows,
            KOKKOS_LAMBDA(int i, double& excess, double& count, double& square) {
                const double d = diagonal(i);
                const double g = d > 0 ? product(i) - b(i) : 0;
                add_residual(q(i), g, watch(i), excess, count, square);
                if (d > 0) q(i) = math::max(0.0, q(i) - omega * g / d);
            },
            s[0], s[1], s[2]);
        if (problem.rows == 0) s = {};
        comm.sum(std::span(s));
        report.residual = {s[0], s[1], s[2]};
        ++report.solve.iterations;
    } while (!ended(goal, report));
    return report;
}

BoundedReport SpectralGradient::solve(
    const Comm& comm, const BoundedProblem& problem, double first, const StoppingTest& goal) {
    reserve(gradient_, static_cast<std::size_t>(problem.rows));
    reserve(change_, static_cast<std::size_t>(problem.rows));
    Kokkos::deep_copy(change_, 0.0);
    Kokkos::deep_copy(gradient_, 0.0);
    BoundedReport report;
    auto& out = report.solve;
    out.products = multiply_guess(comm, problem);
    double alpha = first;
    while (true) {
        const auto now = take_gradient(comm, problem, gradient_, change_);
        report.residual = now.residual;
        if (ended(goal, report)) break;
        const auto& last = now.last;
        const bool shorter = out.iterations % 2 == 0 && last.gradient > 0;
        if (last.across > 0) alpha = shorter ? last.across / last.gradient : last.change / last.across;
        step_down(problem, alpha, gradient_, change_);
        problem.multiply(problem.q);
        ++out.products;
        ++out.iterations;
    }
    if (problem.guess == BoundedGuess::best_multiple) scale_to_least(comm, problem);
    return report;
}

} // namespace treacle::sph
