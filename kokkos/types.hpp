#pragma once
#include <Kokkos_Core.hpp>
#include <Kokkos_MathematicalFunctions.hpp>

#include <cstdint>
#include <limits>

// The subset of Kokkos that compiles with 3.4 and with 4.x/5.x on every back end, under short names.
namespace treacle {

// Device of the build, and the memory that its kernels read.
using Execution = Kokkos::DefaultExecutionSpace;
using Memory = Execution::memory_space;

template <class T>
using Array = Kokkos::View<T*, Memory>;           // [n]
using Array3 = Kokkos::View<double* [3], Memory>; // [n][3]
// Four numbers of a particle that are read together: one aligned load.
using Array4 = Kokkos::View<double* [4], Kokkos::LayoutRight, Memory>;

namespace math {
#if KOKKOS_VERSION >= 30700
using Kokkos::exp;
using Kokkos::fabs;
using Kokkos::floor;
using Kokkos::isfinite;
using Kokkos::pow;
using Kokkos::sqrt;
#else
using Kokkos::Experimental::exp;
using Kokkos::Experimental::fabs;
using Kokkos::Experimental::floor;
using Kokkos::Experimental::pow;
using Kokkos::Experimental::sqrt;
KOKKOS_INLINE_FUNCTION bool isfinite(double x) { return fabs(x) <= std::numeric_limits<double>::max(); }
#endif
inline constexpr double pi = 3.141592653589793238462643383279502884;

// The first of equal numbers; `a` where one is NaN.
template <class T>
KOKKOS_INLINE_FUNCTION constexpr T min(T a, T b) {
    return b < a ? b : a;
}
template <class T>
KOKKOS_INLINE_FUNCTION constexpr T max(T a, T b) {
    return a < b ? b : a;
}
} // namespace math

// The entries where host code may touch them: on a device a copy, in host memory the view itself.
template <class View>
auto on_host(const View& view) {
    return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view);
}

// Grows an array to hold n entries and never shrinks it; the content is lost when it grows. What it has to spare
// keeps a slowly changing count from allocating again at every step.
template <class View>
void reserve(View& view, std::size_t n) {
    if (view.extent(0) >= n) return;
    const std::size_t capacity = n + n / 32 + 16;
    const auto label = view.label();
    view = View(); // frees before it allocates: the peak is one array, not two
    view = View(Kokkos::view_alloc(Kokkos::WithoutInitializing, label), capacity);
}

// Host values at the front of an array, which grows to hold them.
template <class T, class Values>
void assign(Array<T>& array, const Values& values) {
    reserve(array, values.size());
    const Kokkos::View<const T*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> host(values.data(), values.size());
    Kokkos::deep_copy(Kokkos::subview(array, Kokkos::make_pair(std::size_t(0), values.size())), host);
}

// As reserve, but the first `used` rows keep their content.
template <class View>
void reserve_keep(View& view, std::size_t n, std::size_t used) {
    if (view.extent(0) >= n) return;
    View larger(Kokkos::view_alloc(Kokkos::WithoutInitializing, view.label()), n + n / 32 + 16);
    if (used > 0) {
        const auto rows = Kokkos::make_pair(std::size_t(0), used);
        if constexpr (View::rank == 1) {
            Kokkos::deep_copy(Kokkos::subview(larger, rows), Kokkos::subview(view, rows));
        } else {
            Kokkos::deep_copy(Kokkos::subview(larger, rows, Kokkos::ALL()), Kokkos::subview(view, rows, Kokkos::ALL()));
        }
    }
    view = larger;
}

} // namespace treacle
