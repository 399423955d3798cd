#pragma once
#include "kokkos/simd.hpp"

namespace treacle::sph {

// Writes one row and keeps its columns rising. Neighbours come in the order of their rows except at borders, so that
// an entry hardly ever moves.
struct RowWriter {
    int* column;
    double* value; // with room for the whole row, as `column`
    int size = 0;

    // One entry, whose column is not there yet.
    KOKKOS_INLINE_FUNCTION void add(int c, double v) {
        int k = size++;
        for (; k > 0 && column[k - 1] > c; --k) {
            column[k] = column[k - 1];
            value[k] = value[k - 1];
        }
        column[k] = c;
        value[k] = v;
    }
    // Entries of the SIMD elements whose bits are set.
    KOKKOS_INLINE_FUNCTION void add_each(unsigned bits, SimdInt columns, SimdDouble values) {
        add_each(bits, columns, values, [](int column) { return column; });
    }
    // The same with the columns column(key).
    template <class ColumnOf>
    KOKKOS_INLINE_FUNCTION void add_each(unsigned bits, SimdInt keys, SimdDouble values, const ColumnOf& column) {
        int c[lanes];
        double v[lanes];
        store_ints(keys, c);
        store_lanes(values, v);
        for (; bits != 0; bits &= bits - 1) add(column(c[lowest_bit(bits)]), v[lowest_bit(bits)]);
    }
    // The columns rise and lie behind those that are there.
    KOKKOS_INLINE_FUNCTION void append(unsigned bits, SimdInt columns, SimdDouble values) {
        size += compress_store(bits, columns, values, column + size, value + size);
    }
};

} // namespace treacle::sph
