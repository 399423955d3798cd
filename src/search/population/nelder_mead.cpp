#include "search/population/nelder_mead.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
constexpr double no_cut = std::numeric_limits<double>::infinity();

struct Coefficients {
    double expansion, contraction, shrinkage;
    explicit Coefficients(std::size_t dimensions) {
        const double n = std::max(2.0, double(dimensions));
        expansion = 1 + 2 / n;
        contraction = 0.75 - 1 / (2 * n);
        shrinkage = 1 - 1 / n;
    }
};

double bound_of(const Value& f) { return f.is_failed() ? no_cut : f.value(); }
} // namespace

NelderMead::NelderMead(std::vector<Axis> axes, NelderMeadOptions options)
    : Search(std::move(axes), options.limits), options_(options) {}

Task<void> NelderMead::method() {
    co_await begin();
    if (simplex_[0].f.is_failed()) {
        end(StopKind::failed, "failures", "no vertex of the first simplex had a value");
        co_return;
    }
    while (!has_converged()) co_await replace_worst();
}

// The start and a step from it along each axis, away from a bound that is near.
Task<void> NelderMead::begin() {
    std::vector<Point> points(1, start());
    for (std::size_t i = 0; i < dimensions(); ++i) {
        const Axis& axis = axes()[i];
        Point x = start();
        x[i] += axis.start + axis.step <= axis.upper ? axis.step : -axis.step;
        points.push_back(clamped(x));
    }
    const std::vector<Value> values = co_await evaluate(points);
    for (std::size_t k = 0; k < points.size(); ++k) simplex_.push_back({points[k], values[k]});
    sort();
}

void NelderMead::sort() {
    std::stable_sort(simplex_.begin(), simplex_.end(), [](const Vertex& a, const Vertex& b) { return a.f < b.f; });
}

Point NelderMead::along(double factor) const {
    const std::size_t n = dimensions();
    Point x(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t k = 0; k < n; ++k) x[i] += simplex_[k].x[i] / double(n);
        x[i] += factor * (x[i] - simplex_[n].x[i]);
    }
    return clamped(x);
}

Task<NelderMead::Vertex> NelderMead::value_at(Point x, double cut) {
    cut_ = cut;
    std::vector<Point> points(1, x);
    const std::vector<Value> values = co_await evaluate(points);
    cut_ = no_cut;
    others_.clear();
    Vertex out{x, values[0]};
    co_return out;
}

Task<void> NelderMead::replace_worst() {
    const std::size_t n = dimensions();
    const Coefficients c(n);
    const Value best = simplex_[0].f, second_worst = simplex_[n - 1].f, worst = simplex_[n].f;
    others_ = {along(c.contraction), along(-c.contraction), along(c.expansion)};
    const Vertex reflected = co_await value_at(along(1), bound_of(worst));
    if (reflected.f < best) {
        const Vertex expanded = co_await value_at(along(c.expansion), bound_of(reflected.f));
        simplex_[n] = expanded.f < reflected.f ? expanded : reflected;
    } else if (reflected.f < second_worst) {
        simplex_[n] = reflected;
    } else {
        const bool outside = reflected.f < worst;
        const Value least = outside ? reflected.f : worst;
        const Vertex contracted = co_await value_at(along(outside ? c.contraction : -c.contraction), bound_of(least));
        if (contracted.f < least) {
            simplex_[n] = contracted;
        } else {
            co_await shrink();
        }
    }
    sort();
}

Task<void> NelderMead::shrink() {
    const double factor = Coefficients(dimensions()).shrinkage;
    std::vector<Point> points;
    for (std::size_t k = 1; k < simplex_.size(); ++k) {
        Point x = simplex_[k].x;
        for (std::size_t i = 0; i < x.size(); ++i) x[i] = simplex_[0].x[i] + factor * (x[i] - simplex_[0].x[i]);
        points.push_back(x);
    }
    const std::vector<Value> values = co_await evaluate(points);
    for (std::size_t k = 0; k < points.size(); ++k) simplex_[k + 1] = {points[k], values[k]};
}

Point NelderMead::spread() const {
    Point out(dimensions(), 0.0);
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (simplex_.empty()) out[i] = axes()[i].step;
        for (const Vertex& vertex : simplex_) out[i] = std::max(out[i], std::abs(vertex.x[i] - simplex_[0].x[i]));
    }
    return out;
}

bool NelderMead::has_converged() {
    const Point size = spread();
    bool small = true, tiny = true;
    for (std::size_t i = 0; i < size.size(); ++i) {
        small = small && size[i] <= axes()[i].smallest();
        tiny = tiny && size[i] <= 1e-4 * axes()[i].step;
    }
    const Value& worst = simplex_.back().f;
    const double range = worst.is_measured() ? worst.value() - simplex_[0].f.value() : no_cut;
    if (small) {
        end(StopKind::converged, "tolx", "the simplex is below the tolerance on every axis");
    } else if (tiny && range <= options_.value_tolerance) {
        end(StopKind::converged, "tolfun", "the vertices' values differ by less than the tolerance");
    }
    return stopped().has_value();
}

} // namespace treacle::search
