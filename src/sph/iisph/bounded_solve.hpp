#pragma once
#include "kokkos/types.hpp"
#include "mpi/comm.hpp"
#include "solve/krylov/krylov.hpp"

#include <functional>

namespace treacle::sph {

// Guess of a solve: 0, which needs no product; the given one; or that of its multiples with the least q.Aq/2 - b.q, never above
// the value at q = 0.
enum class BoundedGuess { zero, given, best_multiple };

// Ranges of rows, begin(k) <= i < end(k); those that begin beyond the owned rows count as empty. A rank may have none.
struct RowGroups {
    Array<int> begin, end; // [count] rows
    int count = 0;
    bool apply = false; // the same on all ranks
};

// min q.Aq/2 - b.q over q >= 0, A symmetric and positive semidefinite, on the owned rows.
struct BoundedProblem {
    int rows = 0;
    // Collective: product = A vector.
    std::function<void(const Array<double>& vector)> multiply;
    Array<double> product;
    Array<double> diagonal; // > 0, or 0 in rows that stay 0
    Array<double> right_hand_side;
    Array<double> q; // in: guess >= 0, out: solution
    BoundedGuess guess = BoundedGuess::given;
    Array<double> watched; // 1, or 0 in rows that do not count for BoundedResidual::square; empty: all 1
    RowGroups groups;      // over which watched residuals are added up before they are squared, or each row by itself
};

// Distance of q from the solution; sums over the ranks. A row's residual b - A q counts where q > 0, and where it
// would raise q.
struct BoundedResidual {
    double excess = 0; // sum of the positive residuals
    double count = 0;  // rows that count
    double square = 0; // sum of squares of the groups' watched residuals
};

// End of a solve: `met`, the same on every rank, after least_iterations, or max_iterations.
struct StoppingTest {
    std::function<bool(const BoundedResidual&)> met;
    int least_iterations = 0;
    int max_iterations = 0;
};

// Report of either method: outcome, reason, iterations, products; and the last residual.
struct BoundedReport {
    solve::SolveReport solve;
    BoundedResidual residual;
};

// Collective: BoundedResidual::square of q with the gradient A q - b.
double watched_square(const Comm& comm, const BoundedProblem& problem, const Array<double>& gradient);

// q <- max(0, q + omega (b - A q) / diagonal), one product an iteration (Ihmsen et al. 2014). The residual is that
// before the last change. Collective.
BoundedReport bounded_jacobi(const Comm& comm, const BoundedProblem& problem, double omega, const StoppingTest& goal);

// Spectral projected gradients (Birgin, Martinez & Raydan 2000) scaled by the diagonal: q <- max(0, q - alpha (A q - b) / diagonal), one
// product an iteration, alpha by turns the longer and the shorter one of Barzilai & Borwein (1988) (Dai & Fletcher 2005).
// Not monotone: residuals may rise for an iteration or two. Conjugate gradients need a second product whenever the bound cuts
// a step, which in liquids with a free surface is nearly always (src/sph/theory.md). Collective.
class SpectralGradient {
public:
    // first: alpha of the first iteration
    BoundedReport solve(const Comm& comm, const BoundedProblem& problem, double first, const StoppingTest& goal);
    std::size_t bytes() const { return 8 * (gradient_.span() + change_.span()); }

private:
    Array<double> gradient_{"treacle::gradient", 0};
    Array<double> change_{"treacle::change", 0};
};

} // namespace treacle::sph
