#include "sph/bounded_cg.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace treacle::sph {

namespace {
// What one pass over the rows tells of q and the gradient g = A q - b; sums over the ranks.
struct Standing {
    BoundedResidual residual;
    double chopped = 0; // beta.D^-1 beta: rows with q = 0 that want to rise
    double reduced = 0; // phi~.phi: rows with q > 0, as far as the bound lets them fall
    double turn = 0;    // phi.D^-1 A d after a step along d, phi.D^-1 (g - last g) after a cut one
    double free = 0;    // phi.D^-1 phi
};

struct Views {
    Array<double> q, gradient, direction, diagonal, product, right_hand_side, watched;
    KOKKOS_INLINE_FUNCTION double watch(int i) const { return watched.size() > 0 ? watched(i) : 1.0; }
};

// One row's share; the gradient of rows without a diagonal is 0.
KOKKOS_INLINE_FUNCTION void add_row(double q, double g, double inverse, double product, double length, double watched, double sums[7]) {
    const bool counts = q > 0 || g < 0;
    if (!counts) return;
    sums[0] += math::max(0.0, -g);
    sums[1] += 1;
    sums[2] += watched * g * g;
    if (q > 0) {
        sums[4] += math::min(q / length, g * inverse) * g;
        sums[5] += g * inverse * product;
        sums[6] += g * g * inverse;
    } else {
        sums[3] += g * g * inverse;
    }
}

// Calls row(i, sums) for every row and adds the seven sums over the rows and ranks.
template <class Row>
Standing sum_rows(const Comm& comm, int rows, const Row& row) {
    std::array<double, 7> s{};
    Kokkos::parallel_reduce("treacle::bounded_rows", rows,
        KOKKOS_LAMBDA(int i, double& a, double& b, double& c, double& d, double& e, double& f, double& h) {
            double own[7] = {0, 0, 0, 0, 0, 0, 0};
            row(i, own);
            a += own[0];
            b += own[1];
            c += own[2];
            d += own[3];
            e += own[4];
            f += own[5];
            h += own[6];
        }, s[0], s[1], s[2], s[3], s[4], s[5], s[6]);
    if (rows == 0) s = {};
    comm.sum(std::span(s));
    return {{s[0], s[1], s[2]}, s[3], s[4], s[5], s[6]};
}

// g = product - b, the product being A q.
Standing take_gradient(const Comm& comm, int rows, const Views& v, double length) {
    return sum_rows(comm, rows, KOKKOS_LAMBDA(int i, double* sums) {
        const double diagonal = v.diagonal(i);
        const double g = diagonal > 0 ? v.product(i) - v.right_hand_side(i) : 0;
        const double last = v.gradient(i);
        v.gradient(i) = g;
        add_row(v.q(i), g, diagonal > 0 ? 1 / diagonal : 0, g - last, length, v.watch(i), sums);
    });
}

// q -= step d, g -= step A d.
Standing step_along(const Comm& comm, int rows, const Views& v, double step, double length) {
    return sum_rows(comm, rows, KOKKOS_LAMBDA(int i, double* sums) {
        const double diagonal = v.diagonal(i);
        const double q = math::max(0.0, v.q(i) - step * v.direction(i));
        const double g = diagonal > 0 ? v.gradient(i) - step * v.product(i) : 0;
        v.q(i) = q;
        v.gradient(i) = g;
        add_row(q, g, diagonal > 0 ? 1 / diagonal : 0, v.product(i), length, v.watch(i), sums);
    });
}

// Multiplies q and A q by what makes q.Aq/2 - b.q least.
void scale_guess(const Comm& comm, const BoundedProblem& problem) {
    const int rows = problem.rows;
    const auto &q = problem.q, &product = problem.product, &b = problem.right_hand_side;
    std::array<double, 2> dots{};
    Kokkos::parallel_reduce("treacle::bounded_guess", rows, KOKKOS_LAMBDA(int i, double& along, double& curvature) {
        along += b(i) * q(i);
        curvature += product(i) * q(i);
    }, dots[0], dots[1]);
    if (rows == 0) dots = {};
    comm.sum(std::span(dots));
    const double length = dots[1] > 0 ? std::max(0.0, dots[0] / dots[1]) : 0;
    Kokkos::parallel_for("treacle::bounded_scale", rows, KOKKOS_LAMBDA(int i) {
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
    if (problem.guess == BoundedGuess::best_multiple) scale_guess(comm, problem);
    return 1;
}

// q -= step d, cut at 0; g is left stale.
void step_and_cut(int rows, const Views& v, double step) {
    Kokkos::parallel_for("treacle::bounded_cut", rows, KOKKOS_LAMBDA(int i) {
        v.q(i) = math::max(0.0, v.q(i) - step * v.direction(i));
    });
}

// d = D^-1 phi - turn d on the rows with q > 0.
void turn_direction(int rows, const Views& v, double turn) {
    Kokkos::parallel_for("treacle::bounded_turn", rows, KOKKOS_LAMBDA(int i) {
        const bool free = v.q(i) > 0 && v.diagonal(i) > 0;
        v.direction(i) = free ? v.gradient(i) / v.diagonal(i) - (turn != 0 ? turn * v.direction(i) : 0) : 0;
    });
}

// d = D^-1 beta: rows with q = 0 that want to rise.
void release_rows(int rows, const Views& v) {
    Kokkos::parallel_for("treacle::bounded_release", rows, KOKKOS_LAMBDA(int i) {
        const bool rises = v.q(i) <= 0 && v.diagonal(i) > 0;
        v.direction(i) = rises ? math::min(v.gradient(i), 0.0) / v.diagonal(i) : 0;
    });
}

// Length of the minimum along d, and of the way to the bound.
struct Lengths {
    double minimum = 0, bound = 0, curvature = 0;
};
Lengths measure_lengths(const Comm& comm, int rows, const Views& v) {
    std::array<double, 2> dots{};
    double bound = 0;
    Kokkos::parallel_reduce("treacle::bounded_lengths", rows,
        KOKKOS_LAMBDA(int i, double& slope, double& curvature, double& most) {
            const double d = v.direction(i);
            slope += v.gradient(i) * d;
            curvature += v.product(i) * d;
            if (d > 0) most = math::max(most, d / v.q(i)); // d > 0 only where q > 0
        }, dots[0], dots[1], Kokkos::Max<double>(bound));
    if (rows == 0) dots = {}, bound = 0;
    comm.sum(std::span(dots));
    bound = comm.max(bound);
    return {dots[1] > 0 ? dots[0] / dots[1] : 0, bound > 0 ? 1 / bound : 1e300, dots[1]};
}

// True when iterating ends, with the outcome in the report.
bool ended(const BoundedGoal& goal, BoundedReport& report) {
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
} // namespace

BoundedReport bounded_jacobi(const Comm& comm, const BoundedProblem& problem, double omega, const BoundedGoal& goal) {
    BoundedReport report;
    const auto &q = problem.q, &product = problem.product, &b = problem.right_hand_side;
    const auto &diagonal = problem.diagonal, &watched = problem.watched;
    report.solve.products = multiply_guess(comm, problem);
    do {
        if (report.solve.iterations > 0) {
            problem.multiply(q);
            ++report.solve.products;
        }
        report.residual = sum_rows(comm, problem.rows, KOKKOS_LAMBDA(int i, double* sums) {
            const double inverse = diagonal(i) > 0 ? 1 / diagonal(i) : 0;
            const double g = diagonal(i) > 0 ? product(i) - b(i) : 0;
            add_row(q(i), g, inverse, 0, 1, watched.size() > 0 ? watched(i) : 1.0, sums);
            q(i) = math::max(0.0, q(i) - omega * g * inverse);
        }).residual;
        ++report.solve.iterations;
    } while (!ended(goal, report));
    return report;
}

BoundedReport BoundedCg::solve(const Comm& comm, const BoundedProblem& problem, double length,
                               const BoundedGoal& goal) {
    const int n = problem.rows;
    reserve(gradient_, static_cast<std::size_t>(n));
    reserve(direction_, static_cast<std::size_t>(n));
    const Views v{problem.q, gradient_, direction_, problem.diagonal, problem.product, problem.right_hand_side, problem.watched};
    BoundedReport report;
    const auto multiply = [&](const Array<double>& vector) {
        problem.multiply(vector);
        ++report.solve.products;
    };
    const auto restart = [&] {
        multiply(v.q);
        return take_gradient(comm, n, v, length);
    };
    Kokkos::deep_copy(gradient_, 0.0);
    report.solve.products = multiply_guess(comm, problem);
    auto now = take_gradient(comm, n, v, length);
    turn_direction(n, v, 0);
    for (report.residual = now.residual; !ended(goal, report); report.residual = now.residual) {
        ++report.solve.iterations;
        const bool proportional = now.chopped <= now.reduced;
        if (!proportional) release_rows(n, v);
        multiply(v.direction);
        auto along = measure_lengths(comm, n, v);
        if (along.curvature > 0 && along.minimum <= 0) { // uphill, after a cut
            turn_direction(n, v, 0);
            multiply(v.direction);
            along = measure_lengths(comm, n, v);
        }
        if (!(along.curvature > 0)) {
            report.solve.outcome = solve::Outcome::indefinite_matrix;
            report.solve.reason = "the matrix is singular along a direction that the residual needs";
            return report;
        }
        if (!proportional || along.minimum <= along.bound) {
            now = step_along(comm, n, v, along.minimum, length);
            turn_direction(n, v, proportional ? now.turn / along.curvature : 0);
        } else {
            // Conjugate as far as the cut leaves it (Polak & Ribiere 1969).
            step_and_cut(n, v, along.minimum);
            const double before = now.free;
            now = restart();
            turn_direction(n, v, before > 0 ? -std::max(0.0, now.turn / before) : 0);
        }
    }
    return report;
}

} // namespace treacle::sph
