#include "search/cma_es/lq_model.hpp"

#include "search/problem/matrix.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace treacle::search {

namespace {
constexpr double kept = 0.75;         // share of the values, the best ones, that enter a fit
constexpr double surplus = 1.1;       // of values over coefficients before terms are added
constexpr double memory = 2;          // values that are kept over coefficients of the full model
constexpr double largest_weight = 20; // of the best value; the worst has 1

int sign(double x) { return (x > 0) - (x < 0); }
} // namespace

LqModel::LqModel(std::size_t dimensions, std::size_t population) : dimensions_(dimensions), population_(population) {}

std::size_t LqModel::coefficients(Terms terms) const {
    const std::size_t n = dimensions_;
    switch (terms) {
    case Terms::linear: return n + 1;
    case Terms::squares: return 2 * n + 1;
    case Terms::products: break;
    }
    return n * (n + 3) / 2 + 1;
}

LqModel::Terms LqModel::terms() const {
    for (const Terms terms : {Terms::products, Terms::squares})
        if (kept * double(size()) >= surplus * double(coefficients(terms))) return terms;
    return Terms::linear;
}

void LqModel::add(const std::vector<double>& x, double value) {
    entries_.insert(entries_.begin(), Entry{x, value});
    const auto most = std::max(static_cast<std::size_t>(memory * double(coefficients(Terms::products))), population_);
    if (entries_.size() > most) entries_.pop_back();
}

std::vector<double> LqModel::expanded(const std::vector<double>& x, Terms terms) const {
    std::vector<double> d(x);
    for (std::size_t i = 0; i < d.size(); ++i) d[i] -= origin_[i];
    std::vector<double> out{1};
    out.insert(out.end(), d.begin(), d.end());
    if (terms != Terms::linear)
        for (const double c : d) out.push_back(c * c);
    if (terms == Terms::products)
        for (std::size_t i = 0; i < d.size(); ++i)
            for (std::size_t j = i + 1; j < d.size(); ++j) out.push_back(d[i] * d[j]);
    return out;
}

void LqModel::fit(std::size_t newest) {
    const auto better = [](const Entry& a, const Entry& b) { return a.value < b.value; };
    const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(std::min(newest, size()));
    std::stable_sort(entries_.begin(), end, better);
    fitted_ = terms();
    std::vector<std::size_t> order(size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return better(entries_[a], entries_[b]); });
    origin_ = entries_[order[0]].x;
    const auto count =
        std::min(size(), std::max(coefficients(fitted_) + 2, static_cast<std::size_t>(kept * double(size() + 1))));
    Matrix a(std::max(count, coefficients(fitted_)), coefficients(fitted_));
    std::vector<double> b(a.rows(), 0.0);
    for (std::size_t k = 0; k < count; ++k) {
        const double weight = count > 1 ? largest_weight + (1 - largest_weight) * double(k) / double(count - 1) : 1;
        const auto row = expanded(entries_[order[k]].x, fitted_);
        for (std::size_t j = 0; j < row.size(); ++j) a(k, j) = weight * row[j];
        b[k] = weight * entries_[order[k]].value;
    }
    solution_ = least_squares(std::move(a), std::move(b));
}

double LqModel::at(const std::vector<double>& x) const {
    return solution_.empty() ? 0 : dot(solution_, expanded(x, fitted_));
}

namespace {
// The matrix of second derivatives in the order of `expanded`.
Matrix curvature(const std::vector<double>& solution, std::size_t n) {
    Matrix h(n, n);
    for (std::size_t i = 0; i < n; ++i) h(i, i) = 2 * solution[n + 1 + i];
    if (solution.size() == 2 * n + 1) return h;
    std::size_t at = 2 * n + 1;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j) h(i, j) = h(j, i) = solution[at++];
    return h;
}
} // namespace

std::optional<std::vector<double>> LqModel::minimum() const {
    if (solution_.empty() || fitted_ == Terms::linear) return std::nullopt;
    const auto factor = cholesky(curvature(solution_, dimensions_));
    if (!factor) return std::nullopt;
    const std::vector<double> slope(solution_.begin() + 1, solution_.begin() + 1 + std::ptrdiff_t(dimensions_));
    auto x = solve_lower_transposed(*factor, solve_lower(*factor, slope));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = origin_[i] - x[i];
    return x;
}

std::vector<double> LqModel::gradient(const std::vector<double>& x) const {
    std::vector<double> out(solution_.begin() + 1, solution_.begin() + 1 + std::ptrdiff_t(dimensions_));
    if (fitted_ == Terms::linear) return out;
    std::vector<double> d(x);
    for (std::size_t i = 0; i < d.size(); ++i) d[i] -= origin_[i];
    const auto bend = multiply(curvature(solution_, dimensions_), d);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += bend[i];
    return out;
}

double LqModel::agreement(std::size_t newest) const {
    const std::size_t n = std::min(newest, size());
    if (n < 3) return 0;
    int sum = 0;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < i; ++j)
            sum += sign(entries_[i].value - entries_[j].value) * sign(at(entries_[i].x) - at(entries_[j].x));
    return 2.0 * sum / double(n * (n - 1));
}

} // namespace treacle::search
