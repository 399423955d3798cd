#include "search/problem/matrix.hpp"

#include "base/text/contract.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace treacle::search {

namespace {
constexpr double round_off = std::numeric_limits<double>::epsilon();

double off_diagonal(const Matrix& a) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rows(); ++i)
        for (std::size_t j = i + 1; j < a.rows(); ++j) sum += a(i, j) * a(i, j);
    return sum;
}

// The rotation of the axes p and q that makes a(p, q) zero, given to a and to the columns of v.
void rotate(Matrix& a, Matrix& v, std::size_t p, std::size_t q) {
    if (a(p, q) == 0) return;
    const double theta = (a(q, q) - a(p, p)) / (2 * a(p, q));
    const double t = (theta < 0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
    const double c = 1 / std::sqrt(t * t + 1), s = t * c;
    const std::size_t n = a.rows();
    for (std::size_t k = 0; k < n; ++k) {
        const double akp = a(k, p), akq = a(k, q);
        a(k, p) = c * akp - s * akq;
        a(k, q) = s * akp + c * akq;
    }
    for (std::size_t k = 0; k < n; ++k) {
        const double apk = a(p, k), aqk = a(q, k);
        a(p, k) = c * apk - s * aqk;
        a(q, k) = s * apk + c * aqk;
    }
    a(p, q) = a(q, p) = 0;
    for (std::size_t k = 0; k < n; ++k) {
        const double vkp = v(k, p), vkq = v(k, q);
        v(k, p) = c * vkp - s * vkq;
        v(k, q) = s * vkp + c * vkq;
    }
}

SymmetricEigen ordered(const Matrix& a, const Matrix& v) {
    const std::size_t n = a.rows();
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return a(i, i) < a(j, j); });
    SymmetricEigen out{std::vector<double>(n), Matrix(n, n)};
    for (std::size_t j = 0; j < n; ++j) {
        const std::size_t from = order[j];
        std::size_t largest = 0;
        for (std::size_t k = 1; k < n; ++k)
            if (std::abs(v(k, from)) > std::abs(v(largest, from))) largest = k;
        const double sign = v(largest, from) < 0 ? -1 : 1;
        out.values[j] = a(from, from);
        for (std::size_t k = 0; k < n; ++k) out.vectors(k, j) = sign * v(k, from);
    }
    return out;
}

// Reflects the rows from `top` on so that column k of a is zero below it; false where the column depends on those before.
bool reflect(Matrix& a, std::vector<double>& b, std::size_t top, std::size_t k, double scale) {
    const std::size_t m = a.rows();
    double length = 0;
    for (std::size_t i = top; i < m; ++i) length += a(i, k) * a(i, k);
    length = std::sqrt(length);
    if (length <= scale * round_off * double(m)) return false;
    std::vector<double> u(m);
    for (std::size_t i = top; i < m; ++i) u[i] = a(i, k);
    u[top] += a(top, k) < 0 ? -length : length;
    double square = 0;
    for (std::size_t i = top; i < m; ++i) square += u[i] * u[i];
    const auto apply = [&](auto&& entry) {
        double along = 0;
        for (std::size_t i = top; i < m; ++i) along += u[i] * entry(i);
        along *= 2 / square;
        for (std::size_t i = top; i < m; ++i) entry(i) -= along * u[i];
    };
    for (std::size_t j = k; j < a.columns(); ++j) apply([&](std::size_t i) -> double& { return a(i, j); });
    apply([&](std::size_t i) -> double& { return b[i]; });
    return true;
}
} // namespace

Matrix Matrix::identity(std::size_t n) {
    Matrix out(n, n);
    for (std::size_t i = 0; i < n; ++i) out(i, i) = 1;
    return out;
}

double dot(std::span<const double> a, std::span<const double> b) {
    TREACLE_EXPECT(a.size() == b.size());
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

double norm(std::span<const double> a) { return std::sqrt(dot(a, a)); }

std::vector<double> multiply(const Matrix& a, std::span<const double> x) {
    TREACLE_EXPECT(x.size() == a.columns());
    std::vector<double> out(a.rows());
    for (std::size_t i = 0; i < a.rows(); ++i) out[i] = dot(a.row(i), x);
    return out;
}

std::vector<double> multiply_transposed(const Matrix& a, std::span<const double> x) {
    TREACLE_EXPECT(x.size() == a.rows());
    std::vector<double> out(a.columns(), 0.0);
    for (std::size_t i = 0; i < a.rows(); ++i)
        for (std::size_t j = 0; j < a.columns(); ++j) out[j] += a(i, j) * x[i];
    return out;
}

SymmetricEigen symmetric_eigen(Matrix a) {
    const std::size_t n = a.rows();
    Matrix v = Matrix::identity(n);
    double diagonal = 0;
    for (std::size_t i = 0; i < n; ++i) diagonal += a(i, i) * a(i, i);
    constexpr int sweeps = 60; // quadratic convergence needs fewer than ten
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        if (off_diagonal(a) <= 1e-40 * diagonal) break;
        for (std::size_t p = 0; p < n; ++p)
            for (std::size_t q = p + 1; q < n; ++q) rotate(a, v, p, q);
    }
    return ordered(a, v);
}

std::optional<Matrix> cholesky(const Matrix& a) {
    const std::size_t n = a.rows();
    Matrix l(n, n);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            const double rest = a(i, j) - dot(l.row(i).first(j), l.row(j).first(j));
            if (i != j) {
                l(i, j) = rest / l(j, j);
            } else if (rest > 0) {
                l(i, i) = std::sqrt(rest);
            } else {
                return std::nullopt;
            }
        }
    }
    return l;
}

std::vector<double> solve_lower(const Matrix& l, std::span<const double> b) {
    std::vector<double> y(b.begin(), b.end());
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = (y[i] - dot(l.row(i).first(i), std::span(y).first(i))) / l(i, i);
    return y;
}

std::vector<double> solve_lower_transposed(const Matrix& l, std::span<const double> y) {
    std::vector<double> x(y.begin(), y.end());
    for (std::size_t i = x.size(); i-- > 0;) {
        x[i] /= l(i, i);
        for (std::size_t j = 0; j < i; ++j) x[j] -= l(i, j) * x[i];
    }
    return x;
}

std::vector<double> least_squares(Matrix a, std::vector<double> b) {
    const std::size_t n = a.columns();
    std::vector<double> scale(n, 0.0);
    for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t i = 0; i < a.rows(); ++i) scale[j] += a(i, j) * a(i, j);
        scale[j] = std::sqrt(scale[j]);
    }
    std::size_t rank = 0;
    std::vector<std::size_t> columns;
    for (std::size_t k = 0; k < n && rank < a.rows(); ++k) {
        if (!reflect(a, b, rank, k, scale[k])) continue;
        columns.push_back(k);
        ++rank;
    }
    std::vector<double> x(n, 0.0);
    while (rank-- > 0) {
        const std::size_t k = columns[rank];
        double rest = b[rank];
        for (std::size_t j = k + 1; j < n; ++j) rest -= a(rank, j) * x[j];
        x[k] = rest / a(rank, k);
    }
    return x;
}

} // namespace treacle::search
