#pragma once
// Inside src/solve only: Gauss–Seidel sweeps over rows that come in blocks, such as the six motions of an aggregate.
#include "solve/rows/matrix.hpp"

#include <span>
#include <vector>

namespace treacle::solve {

// A rank's own part of a symmetric matrix of dense blocks, as its blocks below the diagonal and on it: these stand for those
// above it too. A sweep reads them once, in the order in which they lie, with one column number a block. Spans are this rank's
// rows.
class BlockSweeps {
public:
    // From rows of which `size` have the same columns, their own block's among them; rising. Sizes are those of rigid motions,
    // 6 and 3; of others nothing is taken. The arrays are copied.
    void take(int size, Index rows, const Index* offsets, const Index* columns, const double* values);
    bool taken() const { return size_ > 0; }

    // z = (D' + L)^-1 r, 1/D' in `inverse`; t = - U z.
    void down_from_zero(
        std::span<const double> inverse, std::span<const double> r, std::span<double> z, std::span<double> t) const;
    // One sweep from z, from the last row to the first.
    void up(std::span<const double> inverse, std::span<const double> r, std::span<double> z);
    // The same and t = r - A z, in two passes.
    void up(std::span<const double> inverse, std::span<const double> r, std::span<double> z, std::span<double> t);

    std::size_t bytes() const; // memory of this rank [bytes]

private:
    template <int M>
    void down_from_zero_of(const double* inverse, const double* r, double* z, double* t) const;
    template <int M>
    void up_of(const double* inverse, const double* r, double* z, double* above, double* t, double* changes) const;
    template <int M>
    void subtract_below(const double* changes, double* t) const;

    int size_ = 0;
    std::vector<Index> offsets_, columns_; // [blocks + 1]; [entries] first row of the block, below the diagonal
    std::vector<double> below_, own_;      // [entries][size][size], [blocks][size][size]
    std::vector<double> above_, changes_;  // [rows] scratch of up()
};

} // namespace treacle::solve
