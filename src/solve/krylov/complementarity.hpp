#pragma once
#include "solve/krylov/krylov.hpp"

#include <span>
#include <vector>

namespace treacle::solve {

// State of each row.
enum class RowState : unsigned char {
    fixed, // x = 0, whatever its gradient
    bound, // x = 0, released when its gradient is negative
    free,  // an unknown; x > 0 in the end
};

// Result of one solve; the same on every rank, its seconds aside.
struct ComplementarityReport {
    SolveReport solve;   // its residual is that of the complementarity problem
    int set_changes = 0; // times that rows were bound or freed
};

// 0 <= x, A x - b >= 0, one of the two zero, A a symmetric M-matrix (off-diagonal entries <= 0, weakly diagonally
// dominant): min x.Ax/2 - b.x over x >= 0. Primal-dual active set (Hintermueller, Ito & Kunisch 2003), which for
// M-matrices ends with exact solves; here conjugate gradients on the free rows change the set as soon as the
// violated conditions outweigh their residual. The gradient of every row comes with the products of the free ones.
// The preconditioner is that of the whole matrix, or one of the first set, and is cut to the free rows: it
// stays symmetric and positive, and is not set up anew.
class ComplementaritySolver {
public:
    ComplementaritySolver(const Comm& comm, std::string prefix, KrylovOptions options);
    ~ComplementaritySolver();
    ComplementaritySolver(ComplementaritySolver&&) noexcept;
    ComplementaritySolver& operator=(ComplementaritySolver&&) noexcept;

    // x: in the guess, out the solution. states: in the first set, out the last, where fixed rows stay fixed. A
    // caller's preconditioner need only serve the rows free at first; others that join them are scaled by their
    // diagonals. The test gets the residual b - A x where x > 0 or b - A x > 0, and 0 elsewhere and on fixed rows;
    // ||b|| is that of the first free rows. Collective.
    ComplementarityReport solve(Matrix& matrix, std::span<const double> b, std::span<double> x,
        std::span<RowState> states, const ConvergenceTest& test);

    // A x - b of the last solve on this rank's rows.
    std::span<const double> gradient() const;

private:
    struct State;
    Comm comm_;
    std::string prefix_;
    KrylovOptions options_;
    std::unique_ptr<State> state_;
};

} // namespace treacle::solve
