#pragma once
// Inside src/solve only: direct solution on the coarsest level.
#include "solve/multigrid/level.hpp"

namespace treacle::solve {

// L D L^T of a symmetric positive semidefinite matrix of a few hundred rows. Directions without a pivot, as of
// constants in a closed box, are left out: the solution is zero there.
class DenseFactor {
public:
    // The level's rows are all on one rank; other ranks hold none.
    void factor(const Level& level);
    // With rows behind them: columns [m][rows of the level], block [m][m].
    void factor(const Level& level, std::span<const double> columns, std::span<const double> block, std::size_t m);
    void solve(std::span<const double> r, std::span<double> z) const;
    std::size_t bytes() const { return 8 * (lower_.capacity() + inverse_.capacity()); }

private:
    std::size_t n_ = 0;
    std::vector<double> lower_;   // [n][n], below the diagonal
    std::vector<double> inverse_; // [n] of D, 0 where there is no pivot
};

} // namespace treacle::solve
