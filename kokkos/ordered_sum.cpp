#include "kokkos/ordered_sum.hpp"

namespace treacle {

const Array<double>& block_sums(int n) {
    static Array<double> sums;
    static const bool freed_with_kokkos = (Kokkos::push_finalize_hook([] { sums = Array<double>(); }), true);
    static_cast<void>(freed_with_kokkos);
    if (!sums.is_allocated()) sums = Array<double>("treacle::block_sums", 0);
    reserve(sums, static_cast<std::size_t>(n));
    return sums;
}

} // namespace treacle
