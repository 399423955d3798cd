#pragma once
#include "kokkos/types.hpp"

namespace treacle {

// Any field value travels as 8-byte words; integers keep their bits.
KOKKOS_INLINE_FUNCTION double to_word(double value) { return value; }
KOKKOS_INLINE_FUNCTION double to_word(std::int64_t value) {
    union {
        std::int64_t integer;
        double word;
    } bits;
    bits.integer = value;
    return bits.word;
}
KOKKOS_INLINE_FUNCTION double to_word(int value) { return to_word(static_cast<std::int64_t>(value)); }

KOKKOS_INLINE_FUNCTION void from_word(double word, double& value) { value = word; }
KOKKOS_INLINE_FUNCTION void from_word(double word, std::int64_t& value) {
    union {
        double word;
        std::int64_t integer;
    } bits;
    bits.word = word;
    value = bits.integer;
}
KOKKOS_INLINE_FUNCTION void from_word(double word, int& value) {
    std::int64_t wide = 0;
    from_word(word, wide);
    value = static_cast<int>(wide);
}

// Rows rows(k) of a field to columns [column, ...) of buffer [n][width], and back to rows first + k.
template <class View>
void pack_rows(const View& field, const Array<int>& rows, int n, const Array<double>& buffer, int width,
               int column) {
    Kokkos::parallel_for("treacle::pack", n, KOKKOS_LAMBDA(int k) {
        const std::int64_t at = std::int64_t(k) * width + column;
        if constexpr (View::rank == 1) {
            buffer(at) = to_word(field(rows(k)));
        } else {
            for (int c = 0; c < 3; ++c) buffer(at + c) = field(rows(k), c);
        }
    });
}

template <class View>
void unpack_rows(const View& field, int first, int n, const Array<double>& buffer, int width, int column) {
    Kokkos::parallel_for("treacle::unpack", n, KOKKOS_LAMBDA(int k) {
        const std::int64_t at = std::int64_t(k) * width + column;
        if constexpr (View::rank == 1) {
            from_word(buffer(at), field(first + k));
        } else {
            for (int c = 0; c < 3; ++c) field(first + k, c) = buffer(at + c);
        }
    });
}

} // namespace treacle
