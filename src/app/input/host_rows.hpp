#pragma once
#include "kokkos/particle_store.hpp"

#include <type_traits>
#include <vector>

namespace treacle::app {

// The first n rows of a field on the host, row by row whatever the layout on the device; integers as int64.
template <class View>
auto host_rows(const View& view, int n) {
    const auto host = on_host(view);
    using Value = typename View::non_const_value_type;                                     // of the device
    using Out = std::conditional_t<std::is_floating_point_v<Value>, double, std::int64_t>; // of the host
    constexpr int width = View::rank == 1 ? 1 : 3;
    std::vector<Out> out(static_cast<std::size_t>(n) * width);
    for (int i = 0; i < n; ++i) {
        if constexpr (View::rank == 1) {
            out[static_cast<std::size_t>(i)] = static_cast<Out>(host(i));
        } else {
            for (int k = 0; k < 3; ++k) out[static_cast<std::size_t>(3 * i + k)] = host(i, k);
        }
    }
    return out;
}

// Rows from the host into the first rows of a field, which must have room for them.
template <class View, class T>
void set_rows(const View& view, const std::vector<T>& rows) {
    const auto host = on_host(view);
    using Value = typename View::non_const_value_type; // of the device
    constexpr std::size_t width = View::rank == 1 ? 1 : 3;
    for (std::size_t i = 0; i < rows.size() / width; ++i) {
        if constexpr (View::rank == 1) {
            host(i) = static_cast<Value>(rows[i]);
        } else {
            for (std::size_t k = 0; k < 3; ++k) host(i, k) = rows[3 * i + k];
        }
    }
    Kokkos::deep_copy(view, host);
}

} // namespace treacle::app
