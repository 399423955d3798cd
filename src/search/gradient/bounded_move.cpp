#include "search/gradient/bounded_move.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
// The d of the free components that solves (a + damping) d = -b, the others kept.
void solve_free(
    const Matrix& a, std::span<const double> b, double damping, const std::vector<bool>& free, std::vector<double>& d) {
    std::vector<std::size_t> index;
    for (std::size_t k = 0; k < free.size(); ++k)
        if (free[k]) index.push_back(k);
    Matrix part(index.size(), index.size());
    std::vector<double> right;
    for (std::size_t i = 0; i < index.size(); ++i) {
        double rest = -b[index[i]];
        for (std::size_t k = 0; k < free.size(); ++k)
            if (!free[k]) rest -= a(index[i], k) * d[k];
        right.push_back(rest);
        for (std::size_t j = 0; j < index.size(); ++j) part(i, j) = a(index[i], index[j]);
        part(i, i) += damping;
    }
    const auto l = cholesky(part);
    if (!l) return;
    const auto x = solve_lower_transposed(*l, solve_lower(*l, right));
    for (std::size_t i = 0; i < index.size(); ++i) d[index[i]] = x[i];
}

std::vector<double> within_bounds(const Matrix& a, std::span<const double> b, double damping, const Room& room) {
    const std::size_t n = b.size();
    std::vector<bool> free(n, true);
    std::vector<double> d(n, 0.0);
    for (std::size_t round = 0; round < 3 * n; ++round) {
        solve_free(a, b, damping, free, d);
        bool changed = false;
        for (std::size_t k = 0; k < n; ++k) {
            if (!free[k] || (d[k] >= room.lower[k] && d[k] <= room.upper[k])) continue;
            d[k] = std::clamp(d[k], room.lower[k], room.upper[k]);
            free[k] = false;
            changed = true;
        }
        for (std::size_t k = 0; !changed && k < n; ++k) {
            const double slope = dot(a.row(k), d) + damping * d[k] + b[k];
            if (free[k] || (d[k] == room.lower[k] ? slope >= 0 : slope <= 0)) continue;
            free[k] = true;
            changed = true;
        }
        if (!changed) break;
    }
    for (std::size_t k = 0; k < n; ++k) d[k] = std::clamp(d[k], room.lower[k], room.upper[k]);
    return d;
}
} // namespace

std::vector<double> bounded_move(const Matrix& a, std::span<const double> b, const Room& room) {
    double trace = 0;
    for (std::size_t k = 0; k < b.size(); ++k) trace += a(k, k);
    if (!(trace > 0)) return std::vector<double>(b.size(), 0.0);
    double low = std::log(1e-12 * trace), high = std::log(trace + norm(b) / room.radius) + 1;
    auto d = within_bounds(a, b, std::exp(low), room);
    if (norm(d) <= room.radius) return d;
    constexpr int bisections = 60;
    for (int k = 0; k < bisections; ++k) {
        const double middle = 0.5 * (low + high);
        d = within_bounds(a, b, std::exp(middle), room);
        (norm(d) > room.radius ? low : high) = middle;
    }
    return within_bounds(a, b, std::exp(high), room);
}

} // namespace treacle::search
