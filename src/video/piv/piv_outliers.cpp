#include "video/piv/piv_outliers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace treacle::video {

namespace {
// Width of the grid along an axis: the least difference of positions.
double grid_width(std::vector<double> positions) {
    std::ranges::sort(positions);
    const double span = positions.back() - positions.front();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < positions.size(); ++i) {
        const double gap = positions[i] - positions[i - 1];
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

// A neighbour of a vector: where it lies on the grid, and one of its components.
struct Neighbour {
    long column, row;
    double value;
};

// Change of a component from one place of the grid to the next along an axis, the median over pairs of neighbours in line.
double slope(const std::vector<Neighbour>& around, long Neighbour::*along, long Neighbour::*across) {
    std::vector<double> slopes;
    for (const auto& a : around) {
        for (const auto& b : around) {
            const long steps = b.*along - a.*along;
            const bool between = steps == 2 && std::ranges::any_of(around, [&](const Neighbour& c) {
                return c.*across == a.*across && c.*along == a.*along + 1;
            });
            if (a.*across == b.*across && steps > 0 && !between) slopes.push_back((b.value - a.value) / double(steps));
        }
    }
    return slopes.empty() ? 0 : median(slopes);
}

// Difference of a component from the neighbours' median over their own scatter, both without the field's slope: at a rim the
// neighbours lie to one side.
double oddness(double value, const std::vector<Neighbour>& neighbours, double noise) {
    const double by_column = slope(neighbours, &Neighbour::column, &Neighbour::row),
                 by_row = slope(neighbours, &Neighbour::row, &Neighbour::column);
    std::vector<double> around;
    around.reserve(neighbours.size());
    for (const auto& one : neighbours)
        around.push_back(one.value - double(one.column) * by_column - double(one.row) * by_row);
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
    const auto cell = [&](std::size_t i) {
        return std::pair(std::lround(field.x[i] / dx), std::lround(field.y[i] / dy));
    };
    std::map<std::pair<long, long>, std::size_t> cells;
    for (std::size_t i = 0; i < field.x.size(); ++i) {
        if (field.valid[i]) cells.emplace(cell(i), i);
    }
    std::vector<std::size_t> odd;
    std::vector<Neighbour> u, v;
    for (const auto& [cell_index, i] : cells) {
        u.clear();
        v.clear();
        for (long row = -1; row <= 1; ++row) {
            for (long column = -1; column <= 1; ++column) {
                const auto found = cells.find({cell_index.first + column, cell_index.second + row});
                if (found == cells.end() || found->second == i) continue;
                u.push_back({column, row, field.u[found->second]});
                v.push_back({column, row, field.v[found->second]});
            }
        }
        if (u.size() < fewest) continue;
        if (std::hypot(oddness(field.u[i], u, noise), oddness(field.v[i], v, noise)) > threshold) odd.push_back(i);
    }
    for (const auto i : odd) field.valid[i] = 0;
    return odd.size();
}

} // namespace treacle::video
