#include "solve/gmres.hpp"

#include "base/clock.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::solve {

namespace {
// A restart that takes less than this off of the residual has come to its end.
constexpr double least_gain = 0.02;
// Rows that are looked at with all vectors before the next ones: what they have of the new vector stays in the cache.
constexpr std::size_t block_rows = 1024;
// Of a vector, what may be left after a subtraction without a second one (Daniel et al. 1976).
constexpr double cancels = 0.5;

double weighted(std::span<const double> weights, std::span<const double> a, std::span<const double> b) {
    const double* const w = weights.data();
    const double* const u = a.data();
    const double* const v = b.data();
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t i = 0; i < weights.size(); ++i) sum += w[i] * u[i] * v[i];
    return sum;
}

void add(double factor, std::span<const double> from, std::span<double> to) {
    const double* const u = from.data();
    double* const v = to.data();
#pragma omp simd
    for (std::size_t i = 0; i < to.size(); ++i) v[i] += factor * u[i];
}

template <class Work>
void each_block(std::size_t rows, const Work& work) {
    for (std::size_t from = 0; from < rows; from += block_rows) work(from, std::min(block_rows, rows - from));
}

// The small least squares problem: R of the Hessenberg matrix by rotations, column by column.
struct LeastSquares {
    std::size_t size;
    std::vector<double> r, cosine, sine, right; // r [size][size + 1], by columns

    LeastSquares(std::size_t n, double first)
        : size(n), r(n * (n + 1), 0.0), cosine(n, 0.0), sine(n, 0.0), right(n + 1, 0.0) {
        right[0] = first;
    }
    std::span<double> column(std::size_t k) { return std::span(r).subspan(k * (size + 1), size + 1); }
    // After column k has been filled, 0 … k + 1.
    void turn(std::size_t k) {
        const auto h = column(k);
        for (std::size_t j = 0; j < k; ++j) {
            const double upper = h[j];
            h[j] = cosine[j] * upper + sine[j] * h[j + 1];
            h[j + 1] = cosine[j] * h[j + 1] - sine[j] * upper;
        }
        const double length = std::hypot(h[k], h[k + 1]);
        cosine[k] = length > 0 ? h[k] / length : 1;
        sine[k] = length > 0 ? h[k + 1] / length : 0;
        h[k] = length;
        right[k + 1] = -sine[k] * right[k];
        right[k] *= cosine[k];
    }
    std::vector<double> solution(std::size_t count) {
        std::vector<double> y(count, 0.0);
        for (std::size_t k = count; k-- > 0;) {
            double sum = right[k];
            for (std::size_t j = k + 1; j < count; ++j) sum -= column(j)[k] * y[j];
            y[k] = column(k)[k] != 0 ? sum / column(k)[k] : 0.0;
        }
        return y;
    }
};
} // namespace

double Gmres::norm(const Operator& a, std::span<const double> r) const {
    return std::sqrt(comm_.sum(weighted(a.weights, r, r)));
}

std::span<double> Gmres::basis(std::size_t k, std::size_t rows) {
    if (basis_.size() <= k) basis_.resize(k + 1);
    basis_[k].resize(rows);
    return basis_[k];
}

// w -= the first vectors by products_.
void Gmres::subtract(std::span<double> w, std::size_t count) const {
    each_block(w.size(), [&](std::size_t from, std::size_t rows) {
        for (std::size_t k = 0; k < count; ++k) {
            add(-products_[k], std::span<const double>(basis_[k]).subspan(from, rows), w.subspan(from, rows));
        }
    });
}

// w loses its parts along the first vectors, which h gets; returns what is left of its length. One sum over the ranks, or
// two where much cancels.
double Gmres::orthogonalise(const Operator& a, std::size_t count, std::span<double> w, std::span<double> h) {
    std::fill(h.begin(), h.end(), 0.0);
    double left = 0;
    for (int pass = 0; pass < 2; ++pass) {
        products_.assign(count + 1, 0.0);
        each_block(w.size(), [&](std::size_t from, std::size_t rows) {
            const std::span<const double> weights = a.weights.subspan(from, rows), part = w.subspan(from, rows);
            for (std::size_t k = 0; k < count; ++k) {
                products_[k] += weighted(weights, std::span<const double>(basis_[k]).subspan(from, rows), part);
            }
            products_[count] += weighted(weights, part, part);
        });
        comm_.sum(std::span(products_));
        left = products_[count];
        subtract(w, count);
        for (std::size_t k = 0; k < count; ++k) {
            h[k] += products_[k];
            left -= products_[k] * products_[k];
        }
        if (left > cancels * products_[count]) break;
    }
    return std::sqrt(std::max(left, 0.0));
}

SolveReport Gmres::solve(const Operator& a, std::span<const double> b, std::span<double> x, double relative) {
    const auto start = Clock::now();
    const std::size_t rows = b.size(), most = static_cast<std::size_t>(options_.restart);
    SolveReport report;
    const double norm_b = norm(a, b), target = relative * norm_b;
    z_.resize(rows);
    const auto end = [&](Outcome outcome, const char* reason) {
        report.outcome = outcome;
        report.reason = reason;
    };
    double before = 0;
    for (bool first = true;; first = false) {
        // v_0 = (b - A x)/|b - A x|
        const auto r = basis(0, rows);
        a.multiply(x, r);
        ++report.products;
        for (std::size_t i = 0; i < rows; ++i) r[i] = b[i] - r[i];
        const double residual = norm(a, r);
        report.error_measure = residual;
        report.relative_residual = norm_b > 0 ? residual / norm_b : residual;
        if (!std::isfinite(residual)) {
            end(Outcome::non_finite, "the system or an iterate is not finite");
            break;
        }
        // Rounding lets the residual of the recurrence be smaller than that of x.
        if (residual <= (first ? 1.0 : 1.01) * target || residual == 0) {
            end(Outcome::converged, "converged");
            break;
        }
        if (report.iterations >= options_.max_iterations) {
            end(Outcome::iteration_limit, "not converged within the limit of iterations");
            break;
        }
        if (!first && residual > (1 - least_gain) * before) {
            end(Outcome::stagnated, "the residual does not fall any more");
            break;
        }
        before = residual;
        for (double& value : r) value /= residual;
        LeastSquares small(most, residual);
        std::size_t count = 0;
        while (count < most && report.iterations < options_.max_iterations && std::fabs(small.right[count]) > target) {
            // w = A M v_k, h = V^T w, v_k+1 = (w - V h)/|…|
            const auto w = basis(count + 1, rows);
            a.precondition(basis_[count], z_);
            a.multiply(z_, w);
            ++report.products;
            ++report.iterations;
            const auto h = small.column(count);
            const double left = orthogonalise(a, count + 1, w, h.first(count + 1));
            h[count + 1] = left;
            small.turn(count);
            ++count;
            if (!(left > 0)) break; // the space has the solution, or a number is not finite
            for (double& value : w) value /= left;
        }
        // x = x + M V y
        const auto y = small.solution(count);
        const auto sum = basis(count, rows);
        std::fill(sum.begin(), sum.end(), 0.0);
        for (std::size_t k = 0; k < count; ++k) add(y[k], basis_[k], sum);
        a.precondition(sum, z_);
        add(1, z_, x);
    }
    report.iteration_seconds = seconds_since(start);
    return report;
}

std::size_t Gmres::bytes() const {
    std::size_t total = z_.capacity();
    for (const auto& vector : basis_) total += vector.capacity();
    return 8 * total;
}

} // namespace treacle::solve
