#include "search/population/gaussian_process.hpp"

#include "search/population/nelder_mead.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace treacle::search {

namespace {
constexpr double least_noise_ratio = 1e-10; // keeps K positive definite
constexpr double prior_deviation = 1;       // of the logarithm of a length

double square(double x) { return x * x; }
} // namespace

GaussianProcess::GaussianProcess(std::vector<std::vector<double>> points, std::vector<double> values)
    : points_(std::move(points)), values_(std::move(values)), best_cost_(std::numeric_limits<double>::infinity()) {
    choose_lengths();
}

double GaussianProcess::kernel(
    const std::vector<double>& a, const std::vector<double>& b, const std::vector<double>& lengths) const {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += square((a[i] - b[i]) / lengths[i]);
    const double r = std::sqrt(5 * sum);
    return (1 + r + r * r / 3) * std::exp(-r);
}

// (G1) -2 ln likelihood = m ln(variance) + ln det K, with the mean and the variance that are best for K.
std::optional<GaussianProcess::Factor> GaussianProcess::factor(
    const std::vector<double>& lengths, double noise_ratio) const {
    const std::size_t m = values_.size();
    Matrix k(m, m);
    for (std::size_t i = 0; i < m; ++i) {
        for (std::size_t j = 0; j < i; ++j) k(i, j) = k(j, i) = kernel(points_[i], points_[j], lengths);
        k(i, i) = 1 + noise_ratio;
    }
    auto lower = cholesky(k);
    if (!lower) return std::nullopt;
    Factor out;
    out.lower = std::move(*lower);
    out.ones = solve_lower(out.lower, std::vector<double>(m, 1.0));
    const auto all = solve_lower(out.lower, values_);
    out.mean = dot(out.ones, all) / dot(out.ones, out.ones);
    for (std::size_t i = 0; i < m; ++i) out.rests.push_back(all[i] - out.mean * out.ones[i]);
    out.variance = std::max(dot(out.rests, out.rests) / double(m), 1e-300);
    out.cost = double(m) * std::log(out.variance);
    for (std::size_t i = 0; i < m; ++i) out.cost += 2 * std::log(out.lower(i, i));
    return out;
}

void GaussianProcess::choose_lengths() {
    for (const double start : {0.0, -1.5})
        for (const double noise_ratio : {1e-8, 1e-2}) choose_lengths_from(start, noise_ratio);
    weights_ = solve_lower_transposed(factor_.lower, factor_.rests);
}

// By the simplex method over the logarithms of lengths and noise, from lengths that are all the same; likelihoods have several maxima.
void GaussianProcess::choose_lengths_from(double start, double noise_ratio) {
    const std::size_t n = points_[0].size();
    std::vector<Axis> axes(n, Axis{std::log(0.02), std::log(10.0), start, 1, 0.05});
    axes.push_back(Axis{std::log(least_noise_ratio), 0, std::log(noise_ratio), 3, 0.2});
    NelderMead search(axes, {.value_tolerance = 1e-3, .limits = {.evaluations = std::int64_t(60 * (n + 1))}});
    while (!search.stopped()) {
        std::vector<Value> costs;
        for (const Point& x : search.ask()) {
            std::vector<double> lengths;
            double prior = 0;
            for (std::size_t i = 0; i < n; ++i) {
                lengths.push_back(std::exp(x[i]));
                prior += square(x[i] / prior_deviation);
            }
            auto found = factor(lengths, std::exp(x[n]));
            costs.push_back(found ? Value::measured(found->cost + prior) : Value::failed());
            if (!found || found->cost + prior >= best_cost_) continue;
            best_cost_ = found->cost + prior;
            lengths_ = lengths;
            noise_ratio_ = std::exp(x[n]);
            factor_ = std::move(*found);
        }
        if (!costs.empty()) search.tell(costs);
    }
}

// (G2) with the uncertainty of the mean.
GaussianProcess::Prediction GaussianProcess::at(const std::vector<double>& x) const {
    std::vector<double> k;
    for (const auto& point : points_) k.push_back(kernel(point, x, lengths_));
    const auto v = solve_lower(factor_.lower, k);
    const double prior_fraction = 1 - dot(v, v),
                 of_mean = square(1 - dot(factor_.ones, v)) / dot(factor_.ones, factor_.ones);
    return {factor_.mean + dot(k, weights_), std::sqrt(factor_.variance * std::max(0.0, prior_fraction + of_mean))};
}

double GaussianProcess::noise() const { return std::sqrt(noise_ratio_ * factor_.variance); }

void GaussianProcess::believe(const std::vector<double>& x, double value) {
    const double variance = factor_.variance;
    points_.push_back(x);
    values_.push_back(value);
    if (auto found = factor(lengths_, noise_ratio_)) {
        factor_ = std::move(*found);
        factor_.variance = variance; // an assumed value has no information on it
        weights_ = solve_lower_transposed(factor_.lower, factor_.rests);
    } else {
        points_.pop_back();
        values_.pop_back();
    }
}

} // namespace treacle::search
