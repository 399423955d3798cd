#pragma once
// Inside src/solve only: a row of a matrix times a vector.
#include "kokkos/types.hpp"
#include "solve/rows/matrix.hpp"

namespace treacle::solve {

// sum_k values[k] z[columns[k]], begin <= k < end, in four sums, for the additions to overlap.
KOKKOS_INLINE_FUNCTION double sparse_dot(
    const Index* columns, const double* values, Index begin, Index end, const double* z) {
    double a = 0, b = 0, c = 0, d = 0;
    Index k = begin;
    for (; k + 4 <= end; k += 4) {
        a += values[k] * z[columns[k]];
        b += values[k + 1] * z[columns[k + 1]];
        c += values[k + 2] * z[columns[k + 2]];
        d += values[k + 3] * z[columns[k + 3]];
    }
    for (; k < end; ++k) a += values[k] * z[columns[k]];
    return (a + b) + (c + d);
}

// Rows of a block of a matrix times a vector, for kernels.
struct RowProduct {
    const Index* offsets = nullptr; // [rows + 1]
    const Index* columns = nullptr; // [entries]
    const double* values = nullptr; // [entries]
    const double* z = nullptr;      // [columns of the block]

    // True where the block has no entry in the row.
    KOKKOS_INLINE_FUNCTION bool is_empty(int row) const { return offsets[row] == offsets[row + 1]; }
    KOKKOS_INLINE_FUNCTION double operator()(int row) const {
        return sparse_dot(columns, values, offsets[row], offsets[row + 1], z);
    }
};

} // namespace treacle::solve
