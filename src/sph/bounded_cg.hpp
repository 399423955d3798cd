#pragma once
#include "kokkos/types.hpp"
#include "mpi/comm.hpp"
#include "solve/krylov.hpp"

#include <functional>

namespace treacle::sph {

// Guess of a solve: 0, which needs no product; the given one; or that of its multiples with the least q.Aq/2 - b.q, never above
// the value at q = 0.
enum class BoundedGuess { zero, given, best_multiple };

// min q.Aq/2 - b.q over q >= 0, A symmetric and positive semidefinite, on the owned rows.
struct BoundedProblem {
    int rows = 0;
    // Collective: product = A vector.
    std::function<void(const Array<double>& vector)> multiply;
    Array<double> product;
    Array<double> diagonal; // > 0, or 0 in rows that stay 0
    Array<double> right_hand_side;
    Array<double> q;        // in: guess >= 0, out: solution
    BoundedGuess guess = BoundedGuess::given;
    Array<double> watched;  // 1, or 0 in rows that do not count for BoundedResidual::square; empty: all 1
};

// How far q is from the solution; sums over the ranks. A row's residual b - A q counts where q > 0, and where it
// would raise q.
struct BoundedResidual {
    double excess = 0; // sum of the positive residuals
    double count = 0;  // rows that count
    double square = 0; // sum of squares, of rows that are watched
};

struct BoundedGoal {
    std::function<bool(const BoundedResidual&)> met;
    int least_iterations = 0;
    int max_iterations = 0;
};

// What both leave: outcome, reason, iterations, products; and the last residual.
struct BoundedReport {
    solve::SolveReport solve;
    BoundedResidual residual;
};

// q <- max(0, q + omega (b - A q) / diagonal), one product an iteration (Ihmsen et al. 2014). The residual is that
// before the last change. Collective.
BoundedReport bounded_jacobi(const Comm& comm, const BoundedProblem& problem, double omega, const BoundedGoal& goal);

// Conjugate gradients with Jacobi scaling on the rows with q > 0. Where a step would make some negative, it is cut at 0,
// and the next direction is as conjugate as that leaves it; rows at 0 come back in when their residuals outweigh the
// others' (proportioning, Dostal 1997; `length` is its measure, in units of the inverse diagonal). Nothing proves that
// it ends, as it would with a gradient step after each cut: that took four times the iterations (README). Collective.
class BoundedCg {
public:
    BoundedReport solve(const Comm& comm, const BoundedProblem& problem, double length, const BoundedGoal& goal);
    std::size_t bytes() const { return 8 * (gradient_.span() + direction_.span()); }

private:
    Array<double> gradient_{"treacle::gradient", 0};
    Array<double> direction_{"treacle::direction", 0};
};

} // namespace treacle::sph
