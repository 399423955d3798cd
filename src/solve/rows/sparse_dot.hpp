#pragma once
// Inside src/solve only: a row of a matrix times a vector.
#include "solve/rows/matrix.hpp"

namespace treacle::solve {

// sum_k values[k] z[columns[k]], begin <= k < end, in four sums, for the additions to overlap.
inline double sparse_dot(const Index* columns, const double* values, Index begin, Index end, const double* z) {
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

} // namespace treacle::solve
