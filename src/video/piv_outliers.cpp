#include "video/piv_outliers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace treacle::video {

namespace {
// Width of the grid along an axis: the least difference of places.
double grid_width(std::vector<double> places) {
    std::ranges::sort(places);
    const double span = places.back() - places.front();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < places.size(); ++i) {
        const double gap = places[i] - places[i - 1];
        if (gap > 1e-6 * span) least = std::min(least, gap);
    }
    return std::isfinite(least) ? least : 1;
}

double median(std::vector<double>& values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::ranges::nth_element(values, middle);
    if (values.size() % 2 == 1) return *middle;
    return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

// Difference of a component from the neighbours' median over their own scatter.
double oddness(double value, const std::vector<double>& around, double noise) {
    auto work = around;
    const double centre = median(work);
    for (std::size_t i = 0; i < work.size(); ++i) work[i] = std::abs(around[i] - centre);
    return (value - centre) / (median(work) + noise);
}
} // namespace

std::size_t reject_odd(PivField& field, double threshold, double noise) {
    constexpr std::size_t fewest = 3;
    if (field.x.size() < 2) return 0;
    const double dx = grid_width(field.x), dy = grid_width(field.y);
    const auto cell = [&](std::size_t i) { return std::pair(std::lround(field.x[i] / dx), std::lround(field.y[i] / dy)); };
    std::map<std::pair<long, long>, std::size_t> places;
    for (std::size_t i = 0; i < field.x.size(); ++i) {
        if (field.valid[i]) places.emplace(cell(i), i);
    }
    std::vector<std::size_t> odd;
    std::vector<double> u, v;
    for (const auto& [place, i] : places) {
        u.clear();
        v.clear();
        for (long row = -1; row <= 1; ++row) {
            for (long column = -1; column <= 1; ++column) {
                const auto found = places.find({place.first + column, place.second + row});
                if (found == places.end() || found->second == i) continue;
                u.push_back(field.u[found->second]);
                v.push_back(field.v[found->second]);
            }
        }
        if (u.size() < fewest) continue;
        if (std::hypot(oddness(field.u[i], u, noise), oddness(field.v[i], v, noise)) > threshold) odd.push_back(i);
    }
    for (const auto i : odd) field.valid[i] = 0;
    return odd.size();
}

} // namespace treacle::video
