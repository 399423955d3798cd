#pragma once
#include "kokkos/types.hpp"

namespace treacle {

// Makes of counts[0 .. n) the offsets [0 .. n] of rows that stand one behind the other; returns their sum.
template <class Integer>
std::int64_t counts_to_offsets(const Array<Integer>& counts, int n) {
    std::int64_t total = 0;
    Kokkos::parallel_scan(
        "treacle::counts_to_offsets", n + 1,
        KOKKOS_LAMBDA(int i, std::int64_t& sum, bool last) {
            const std::int64_t count = i < n ? counts(i) : 0;
            if (last) counts(i) = static_cast<Integer>(sum);
            sum += count;
        },
        total);
    return total;
}

} // namespace treacle
