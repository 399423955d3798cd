#pragma once
// Inside src/solve only: this rank's share of the vector operations of Krylov methods, each one pass
// over memory. The pragmas allow the sums to run in several lanes; the order stays the same from run to run.
#include <cstddef>
#include <span>

namespace treacle::solve {

// Sum of a b over this rank's rows.
inline double dot(std::span<const double> a, std::span<const double> b) {
    const double* const u = a.data();
    const double* const v = b.data();
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t i = 0; i < a.size(); ++i) sum += u[i] * v[i];
    return sum;
}

// Sum of weights a b.
inline double weighted(std::span<const double> weights, std::span<const double> a, std::span<const double> b) {
    const double* const w = weights.data();
    const double* const u = a.data();
    const double* const v = b.data();
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t i = 0; i < weights.size(); ++i) sum += w[i] * u[i] * v[i];
    return sum;
}

// Sum of a over this rank's rows.
inline double total(std::span<const double> a) {
    const double* const u = a.data();
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t i = 0; i < a.size(); ++i) sum += u[i];
    return sum;
}

// Sum of (a - shift)^2.
inline double squares(std::span<const double> a, double shift) {
    const double* const u = a.data();
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t i = 0; i < a.size(); ++i) sum += (u[i] - shift) * (u[i] - shift);
    return sum;
}

// x += alpha p, r -= alpha q; returns r.r.
inline double step(
    double alpha, std::span<const double> p, std::span<const double> q, std::span<double> x, std::span<double> r) {
    const double* const direction = p.data();
    const double* const product = q.data();
    double* const solution = x.data();
    double* const residual = r.data();
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t i = 0; i < x.size(); ++i) {
        solution[i] += alpha * direction[i];
        const double value = residual[i] - alpha * product[i];
        residual[i] = value;
        sum += value * value;
    }
    return sum;
}

// r = b - shift - q; returns r.r.
inline double subtract(std::span<const double> b, double shift, std::span<const double> q, std::span<double> r) {
    const double* const left = b.data();
    const double* const right = q.data();
    double* const residual = r.data();
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t i = 0; i < b.size(); ++i) {
        const double value = left[i] - shift - right[i];
        residual[i] = value;
        sum += value * value;
    }
    return sum;
}

// to += factor from.
inline void add(double factor, std::span<const double> from, std::span<double> to) {
    const double* const u = from.data();
    double* const v = to.data();
#pragma omp simd
    for (std::size_t i = 0; i < to.size(); ++i) v[i] += factor * u[i];
}

// p = z + beta p.
inline void turn(double beta, std::span<const double> z, std::span<double> p) {
    const double* const gradient = z.data();
    double* const direction = p.data();
#pragma omp simd
    for (std::size_t i = 0; i < p.size(); ++i) direction[i] = gradient[i] + beta * direction[i];
}

} // namespace treacle::solve
