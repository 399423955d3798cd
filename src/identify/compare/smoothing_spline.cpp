#include "identify/compare/smoothing_spline.hpp"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace treacle::identify {

namespace {
using Sparse = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;

// Q [n][n - 2] of second differences and R [n - 2][n - 2], such that R bends = Q^T values (Green & Silverman 1994, 2.1).
struct Bands {
    Sparse q, r;
};

Bands bands_of(const std::vector<double>& times) {
    const auto n = Eigen::Index(times.size());
    std::vector<Eigen::Triplet<double>> q, r;
    for (Eigen::Index j = 0; j + 2 < n; ++j) {
        const double before = times[std::size_t(j + 1)] - times[std::size_t(j)],
                     after = times[std::size_t(j + 2)] - times[std::size_t(j + 1)];
        q.emplace_back(j, j, 1 / before);
        q.emplace_back(j + 1, j, -1 / before - 1 / after);
        q.emplace_back(j + 2, j, 1 / after);
        r.emplace_back(j, j, (before + after) / 3);
        if (j + 3 < n) {
            r.emplace_back(j, j + 1, after / 6);
            r.emplace_back(j + 1, j, after / 6);
        }
    }
    Bands out{Sparse(n, n - 2), Sparse(n - 2, n - 2)};
    out.q.setFromTriplets(q.begin(), q.end());
    out.r.setFromTriplets(r.begin(), r.end());
    return out;
}

// Bends of the spline with this weight of its roughness: (R + weight Q^T S Q) bends = Q^T y, S the squares of the deviations.
Vector bends_of(const Bands& bands, const Vector& squares, const Vector& values, double weight) {
    const Sparse system = bands.r + weight * Sparse(bands.q.transpose() * squares.asDiagonal() * bands.q);
    return Eigen::SimplicialLDLT<Sparse>(system).solve(Vector(bands.q.transpose() * values));
}
} // namespace

SmoothingSpline::SmoothingSpline(
    std::span<const double> times, std::span<const double> values, std::span<const double> deviations)
    : times_(times.begin(), times.end()), values_(values.begin(), values.end()), bends_(times.size()) {
    const auto n = times.size();
    if (n < 2 || values.size() != n || deviations.size() != n ||
        std::ranges::adjacent_find(times_, std::greater_equal<>()) != times_.end()) {
        throw std::invalid_argument("a spline needs two times at least that grow");
    }
    if (n == 2) return;
    const auto bands = bands_of(times_);
    const Vector y = Eigen::Map<const Vector>(values.data(), Eigen::Index(n));
    const Vector squares = Eigen::Map<const Vector>(deviations.data(), Eigen::Index(n)).cwiseAbs2();
    // Misfit S Q bends weight, in units of the deviations.
    const auto misfit = [&](double weight, const Vector& bends) {
        return weight * weight * (squares.asDiagonal() * Vector(bands.q * bends)).dot(Vector(bands.q * bends));
    };
    double weight = 0;
    if (squares.maxCoeff() > 0) {
        double low = -80, high = 80; // of the logarithm
        for (int k = 0; k < 80; ++k) {
            const double middle = 0.5 * (low + high), w = std::exp(middle);
            (misfit(w, bends_of(bands, squares, y, w)) < double(n) ? low : high) = middle;
        }
        weight = std::exp(low);
    }
    const Vector bends = bends_of(bands, squares, y, weight);
    const Vector smooth = y - weight * (squares.asDiagonal() * Vector(bands.q * bends));
    std::copy_n(smooth.data(), n, values_.begin());
    std::copy_n(bends.data(), n - 2, bends_.begin() + 1);
}

std::size_t SmoothingSpline::interval_of(double time) const {
    const auto next = std::ranges::upper_bound(times_, time);
    return std::size_t(std::clamp<std::ptrdiff_t>(next - times_.begin() - 1, 0, std::ptrdiff_t(times_.size()) - 2));
}

double SmoothingSpline::at(double time) const {
    const double inside = std::clamp(time, first(), last());
    const auto i = interval_of(inside);
    const double h = times_[i + 1] - times_[i], a = (times_[i + 1] - inside) / h, b = 1 - a;
    const double value = a * values_[i] + b * values_[i + 1] +
                         ((a * a * a - a) * bends_[i] + (b * b * b - b) * bends_[i + 1]) * h * h / 6;
    return value + (time - inside) * (time == inside ? 0 : slope(inside));
}

double SmoothingSpline::slope(double time) const {
    const double inside = std::clamp(time, first(), last());
    const auto i = interval_of(inside);
    const double h = times_[i + 1] - times_[i], a = (times_[i + 1] - inside) / h, b = 1 - a;
    return (values_[i + 1] - values_[i]) / h + ((1 - 3 * a * a) * bends_[i] + (3 * b * b - 1) * bends_[i + 1]) * h / 6;
}

} // namespace treacle::identify
