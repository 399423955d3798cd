#pragma once
// Inside src/solve only: a smoother all of whose loops are kernels.
#include "solve/multigrid/level.hpp"

#include <span>
#include <vector>

namespace treacle::solve {

// (ML6) Chebyshev polynomial of D^-1 A of degree 2 on the upper part of its eigenvalues (Saad 2003, algorithm 12.1). An
// error along an eigenvector is multiplied by 1 - x q(x), x its eigenvalue; the modulus of that is below 1 for each. There
// is no order of the rows, so that neither ranks nor threads change the result but by rounding. Collective: all but
// eigenvalue_bound() and bytes(). Spans are this rank's rows.
class Chebyshev {
public:
    // The level is ready for products; D and the rows where z stays 0 are those of its inverse_diagonal().
    void set_up(const Comm& comm, const Level& level);
    // z = q(D^-1 A) D^-1 r
    void start(Level& level, std::span<const double> r, std::span<double> z);
    // z += q(D^-1 A) D^-1 (r - A z)
    void improve(Level& level, std::span<const double> r, std::span<double> z);

    // Gershgorin's, of D^-1 A: the largest sum of moduli of a row. At most 2 where A is diagonally dominant; 0 where no row
    // has a diagonal entry.
    double eigenvalue_bound() const { return bound_; }
    std::size_t bytes() const { return 8 * change_.capacity(); } // memory of this rank [bytes]

private:
    double bound_ = 0;
    double first_ = 0, keep_ = 0, second_ = 0; // d = first D^-1 r; then d = keep d + second D^-1 r, r the residual
    std::vector<double> change_;               // [rows] d, the last change of z
};

} // namespace treacle::solve
