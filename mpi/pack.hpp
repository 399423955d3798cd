#pragma once
#include "kokkos/types.hpp"

namespace treacle {

// Any field value travels as 8-byte words; integers keep their bits.
KOKKOS_INLINE_FUNCTION double to_word(double value) { return value; }
KOKKOS_INLINE_FUNCTION double to_word(std::int64_t value) {
    union {
        std::int64_t integer; // bits as stored
        double word;          // bits as sent
    } bits;
    bits.integer = value;
    return bits.word;
}
// Sent as 64 bits.
KOKKOS_INLINE_FUNCTION double to_word(int value) { return to_word(static_cast<std::int64_t>(value)); }

// Inverse of to_word().
KOKKOS_INLINE_FUNCTION void from_word(double word, double& value) { value = word; }
KOKKOS_INLINE_FUNCTION void from_word(double word, std::int64_t& value) {
    union {
        double word;          // bits as sent
        std::int64_t integer; // bits as stored
    } bits;
    bits.word = word;
    value = bits.integer;
}
// The lower 32 bits of what was sent.
KOKKOS_INLINE_FUNCTION void from_word(double word, int& value) {
    std::int64_t wide = 0;
    from_word(word, wide);
    value = static_cast<int>(wide);
}

// One row of a field to words and back, or summed. Free functions: nvcc takes no lambda whose first use of a
// captured array is inside `if constexpr`.
template <class View>
KOKKOS_INLINE_FUNCTION void pack_row(const View& field, int row, double* words) {
    if constexpr (View::rank == 1) {
        words[0] = to_word(field(row));
    } else {
        for (int c = 0; c < 3; ++c) words[c] = field(row, c);
    }
}
template <class View>
KOKKOS_INLINE_FUNCTION void unpack_row(const View& field, int row, const double* words) {
    if constexpr (View::rank == 1) {
        from_word(words[0], field(row));
    } else {
        for (int c = 0; c < 3; ++c) field(row, c) = words[c];
    }
}
template <class View>
KOKKOS_INLINE_FUNCTION void add_row(const View& field, int row, const double* words) {
    if constexpr (View::rank == 1) {
        field(row) += words[0];
    } else {
        for (int c = 0; c < 3; ++c) field(row, c) += words[c];
    }
}

// Columns [column, ...) of a buffer [n][width], those of one field.
struct BufferColumns {
    Array<double> buffer; // [n][width]
    int width, column;    // of a row, in doubles; the first of the field
    KOKKOS_INLINE_FUNCTION double* row(std::int64_t k) const { return &buffer(k * width + column); }
};

// Rows rows(k) of a field to a buffer, and back to rows first + k.
template <class View>
void pack_rows(const View& field, const Array<int>& rows, int n, const BufferColumns& to) {
    Kokkos::parallel_for(
        "treacle::pack", n, KOKKOS_LAMBDA(int k) { pack_row(field, rows(k), to.row(k)); });
}

// Words of n rows of the buffer, into the rows [first, first + n) of the field.
template <class View>
void unpack_rows(const View& field, int first, int n, const BufferColumns& from) {
    Kokkos::parallel_for(
        "treacle::unpack", n, KOKKOS_LAMBDA(int k) { unpack_row(field, first + k, from.row(k)); });
}

} // namespace treacle
