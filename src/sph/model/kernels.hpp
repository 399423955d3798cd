#pragma once
#include "kokkos/simd.hpp"

namespace treacle::sph {

// Kernel of all pair sums of a run.
enum class KernelKind { cubic_spline, wendland_c2, mueller };

// Smoothing kernels of compact support h [m] in D dimensions. `value` is W(r) [1/m^D]; `gradient` is
// W'(r)/r [1/m^(D+2)], so that the gradient at x_i is gradient(r) (x_i - x_j); `radial` is W'(r) r [1/m^D], which
// needs no division. All require r < h. Templates over a number or several, and 1/r where it is known already.

// Monaghan & Lattanzio 1985, with h as the support radius.
template <int D>
struct CubicSpline {
    static constexpr int dimensions = D;
    double h, inverse_h, scale, gradient_scale; // [m], [1/m], [1/m^D], [1/m^(D+2)]

    // Support h [m]; W, W'/r and W' r of r [m], with inverse_r = 1/r [1/m].
    explicit CubicSpline(double support) : h(support), inverse_h(1 / support) {
        scale = D == 3 ? 8 / (math::pi * h * h * h) : 40 / (7 * math::pi * h * h);
        gradient_scale = -6 * scale / (h * h);
    }
    template <Number T>
    KOKKOS_INLINE_FUNCTION T value(T r) const {
        const T q = r * inverse_h, a = 1 - q, b = math::max(0.5 - q, T(0.0));
        return 2 * scale * (a * a * a - 4 * b * b * b);
    }
    template <Number T>
    KOKKOS_INLINE_FUNCTION T gradient(T r, T inverse_r) const {
        const T q = r * inverse_h, a = 1 - q;
        return gradient_scale * select(q < 0.5, 2 - 3 * q, a * a * (h * inverse_r));
    }
    template <Number T>
    KOKKOS_INLINE_FUNCTION T radial(T r) const {
        const T q = r * inverse_h, a = 1 - q;
        return gradient_scale * h * r * select(q < 0.5, q * (2 - 3 * q), a * a);
    }
    KOKKOS_INLINE_FUNCTION double gradient(double r) const { return gradient(r, 1 / r); }
};

// Wendland 1995.
template <int D>
struct WendlandC2 {
    static constexpr int dimensions = D;
    double h, inverse_h, scale, gradient_scale; // [m], [1/m], [1/m^D], [1/m^(D+2)]

    // Support h [m]; W, W'/r and W' r of r [m]. No 1/r is read.
    explicit WendlandC2(double support) : h(support), inverse_h(1 / support) {
        scale = D == 3 ? 21 / (2 * math::pi * h * h * h) : 7 / (math::pi * h * h);
        gradient_scale = -20 * scale / (h * h);
    }
    template <Number T>
    KOKKOS_INLINE_FUNCTION T value(T r) const {
        const T q = r * inverse_h, a = 1 - q, a2 = a * a;
        return scale * a2 * a2 * (4 * q + 1);
    }
    template <Number T>
    KOKKOS_INLINE_FUNCTION T gradient(T r, T) const {
        const T a = 1 - r * inverse_h;
        return gradient_scale * a * a * a;
    }
    template <Number T>
    KOKKOS_INLINE_FUNCTION T radial(T r) const {
        return gradient(r, r) * r * r;
    }
    KOKKOS_INLINE_FUNCTION double gradient(double r) const { return gradient(r, r); }
};

// Mueller, Charypar & Gross 2003: poly6 for values, spiky for gradients; the dissertation's own pair.
template <int D>
struct Mueller {
    static constexpr int dimensions = D;
    double h, scale, gradient_scale; // [m], [1/m^(D+6)], [1/m^(D+3)]

    // Support h [m]; W, W'/r and W' r of r [m], with inverse_r = 1/r [1/m], which counts up to 1e9/h.
    explicit Mueller(double support) : h(support) {
        const double h2 = h * h, h4 = h2 * h2;
        scale = D == 3 ? 315 / (64 * math::pi * h4 * h4 * h) : 4 / (math::pi * h4 * h4);
        gradient_scale = D == 3 ? -45 / (math::pi * h4 * h2) : -30 / (math::pi * h4 * h);
    }
    template <Number T>
    KOKKOS_INLINE_FUNCTION T value(T r) const {
        const T a = h * h - r * r;
        return scale * a * a * a;
    }
    template <Number T>
    KOKKOS_INLINE_FUNCTION T gradient(T r, T inverse_r) const {
        const T a = h - r;
        return gradient_scale * a * a * math::min(inverse_r, T(1e9 / h));
    }
    template <Number T>
    KOKKOS_INLINE_FUNCTION T radial(T r) const {
        const T a = h - r;
        return gradient_scale * a * a * r;
    }
    KOKKOS_INLINE_FUNCTION double gradient(double r) const { return gradient(r, 1 / r); }
};

// The spiky number-density kernel of Koshizuka & Oka 1996, w(r) = h/r - 1, without a self term; r is kept
// off zero at a tenth of the spacing.
struct NumberKernel {
    double h, least; // [m]
    NumberKernel(double support, double spacing) : h(support), least(0.1 * spacing) {}
    template <Number T>
    KOKKOS_INLINE_FUNCTION T value(T r) const {
        return h * inverse(math::max(r, T(least))) - 1;
    }
};

// Calls work(kernel) with the kernel of a kind and a number of dimensions.
template <class Work>
void with_kernel(KernelKind kind, int dimensions, double support, const Work& work) {
    const bool plane = dimensions == 2;
    switch (kind) {
    case KernelKind::cubic_spline: plane ? work(CubicSpline<2>(support)) : work(CubicSpline<3>(support)); break;
    case KernelKind::wendland_c2: plane ? work(WendlandC2<2>(support)) : work(WendlandC2<3>(support)); break;
    case KernelKind::mueller: plane ? work(Mueller<2>(support)) : work(Mueller<3>(support)); break;
    }
}

} // namespace treacle::sph
