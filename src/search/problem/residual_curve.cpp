#include "search/problem/residual_curve.hpp"

#include "search/problem/huber.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace treacle::search {

namespace {
constexpr double bend = 3; // noises beyond which residuals count linearly
} // namespace

void ResidualCurve::add(double x, std::vector<double> residuals) {
    if (std::ranges::any_of(points_, [&](const Point& one) { return one.x == x; })) return;
    points_.push_back({x, std::move(residuals)});
}

std::vector<const ResidualCurve::Point*> ResidualCurve::three(double best) const {
    std::vector<const Point*> out;
    for (const auto& one : points_) out.push_back(&one);
    std::ranges::stable_sort(out, {}, [&](const Point* one) { return std::abs(one->x - best); });
    out.resize(std::min<std::size_t>(out.size(), 3));
    return out;
}

bool ResidualCurve::is_known(double best) const { return points_.size() >= 3 && three(best).front()->x == best; }

double ResidualCurve::nearest(double best) const {
    double out = std::numeric_limits<double>::infinity();
    for (const auto& one : points_)
        if (one.x != best) out = std::min(out, std::abs(one.x - best));
    return out;
}

double ResidualCurve::least(double best, double lower, double upper, double step) const {
    const auto at = three(best);
    const int count = std::max(1, int(std::lround((upper - lower) / step)));
    double least = std::numeric_limits<double>::infinity(), where = best;
    for (int k = 0; k <= count; ++k) {
        const double x = lower + (upper - lower) * k / count;
        std::array<double, 3> weight{}; // Lagrange's polynomials
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3, l = (i + 2) % 3;
            weight[std::size_t(i)] =
                (x - at[std::size_t(j)]->x) * (x - at[std::size_t(l)]->x) /
                ((at[std::size_t(i)]->x - at[std::size_t(j)]->x) * (at[std::size_t(i)]->x - at[std::size_t(l)]->x));
        }
        double sum = 0;
        for (std::size_t row = 0; row < at[0]->residuals.size(); ++row) {
            const double r = weight[0] * at[0]->residuals[row] + weight[1] * at[1]->residuals[row] +
                             weight[2] * at[2]->residuals[row];
            if (std::isfinite(r)) sum += huber_loss(r, bend);
        }
        if (sum < least) {
            least = sum;
            where = x;
        }
    }
    return where;
}

} // namespace treacle::search
