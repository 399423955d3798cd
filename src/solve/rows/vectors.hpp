#pragma once
// Inside src/solve only: the vector operations of Krylov methods and smoothers on this rank's rows, a kernel and one pass over memory each.
// Sums come in an order that does not depend on threads (kokkos/ordered_sum.hpp).
#include "kokkos/ordered_sum.hpp"

#include <cstddef>
#include <span>

namespace treacle::solve {

// Sum of a b over this rank's rows.
inline double dot(std::span<const double> a, std::span<const double> b) {
    const double* const u = a.data();
    const double* const v = b.data();
    return ordered_sum(
        "treacle::dot", static_cast<int>(a.size()), KOKKOS_LAMBDA(int i) { return u[i] * v[i]; });
}

// Sum of weights a b.
inline double weighted(std::span<const double> weights, std::span<const double> a, std::span<const double> b) {
    const double* const w = weights.data();
    const double* const u = a.data();
    const double* const v = b.data();
    return ordered_sum(
        "treacle::weighted_dot", static_cast<int>(a.size()), KOKKOS_LAMBDA(int i) { return w[i] * u[i] * v[i]; });
}

// Sum of a over this rank's rows.
inline double total(std::span<const double> a) {
    const double* const u = a.data();
    return ordered_sum(
        "treacle::total", static_cast<int>(a.size()), KOKKOS_LAMBDA(int i) { return u[i]; });
}

// Sum of (a - shift)^2.
inline double squares(std::span<const double> a, double shift) {
    const double* const u = a.data();
    return ordered_sum(
        "treacle::squares", static_cast<int>(a.size()),
        KOKKOS_LAMBDA(int i) { return (u[i] - shift) * (u[i] - shift); });
}

// x += alpha p, r -= alpha q; returns r.r.
inline double step(
    double alpha, std::span<const double> p, std::span<const double> q, std::span<double> x, std::span<double> r) {
    const double* const direction = p.data();
    const double* const product = q.data();
    double* const solution = x.data();
    double* const residual = r.data();
    return ordered_sum(
        "treacle::step", static_cast<int>(x.size()), KOKKOS_LAMBDA(int i) {
            solution[i] += alpha * direction[i];
            const double value = residual[i] - alpha * product[i];
            residual[i] = value;
            return value * value;
        });
}

// r = b - shift - q; returns r.r.
inline double subtract(std::span<const double> b, double shift, std::span<const double> q, std::span<double> r) {
    const double* const left = b.data();
    const double* const right = q.data();
    double* const residual = r.data();
    return ordered_sum(
        "treacle::subtract", static_cast<int>(b.size()), KOKKOS_LAMBDA(int i) {
            const double value = left[i] - shift - right[i];
            residual[i] = value;
            return value * value;
        });
}

// to += factor from.
inline void add(double factor, std::span<const double> from, std::span<double> to) {
    const double* const u = from.data();
    double* const v = to.data();
    Kokkos::parallel_for(
        "treacle::add", static_cast<int>(to.size()), KOKKOS_LAMBDA(int i) { v[i] += factor * u[i]; });
}

// to = factor weights from.
inline void scale(double factor, std::span<const double> weights, std::span<const double> from, std::span<double> to) {
    const double* const w = weights.data();
    const double* const u = from.data();
    double* const v = to.data();
    Kokkos::parallel_for(
        "treacle::scale", static_cast<int>(to.size()), KOKKOS_LAMBDA(int i) { v[i] = factor * w[i] * u[i]; });
}

// to += factor weights from.
inline void add(double factor, std::span<const double> weights, std::span<const double> from, std::span<double> to) {
    const double* const w = weights.data();
    const double* const u = from.data();
    double* const v = to.data();
    Kokkos::parallel_for(
        "treacle::add_weighted", static_cast<int>(to.size()), KOKKOS_LAMBDA(int i) { v[i] += factor * w[i] * u[i]; });
}

// p = z + beta p.
inline void turn(double beta, std::span<const double> z, std::span<double> p) {
    const double* const gradient = z.data();
    double* const direction = p.data();
    Kokkos::parallel_for(
        "treacle::turn", static_cast<int>(p.size()),
        KOKKOS_LAMBDA(int i) { direction[i] = gradient[i] + beta * direction[i]; });
}

} // namespace treacle::solve
