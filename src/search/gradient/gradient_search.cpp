#include "search/gradient/gradient_search.hpp"

#include "search/problem/matrix.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
constexpr double enough = 1e-4; // share of the descent that the slope predicts (Armijo)
constexpr int most_trials = 30;

// The vertex of the parabola with a value and slope at 0 and a value at t; none where it is not a minimum.
std::optional<double> vertex(double f0, double slope, double t, const Value& f) {
    if (!f.is_measured()) return std::nullopt;
    const double bend = f.value() - f0 - slope * t;
    if (!(bend > 0)) return std::nullopt;
    return -slope * t * t / (2 * bend);
}
} // namespace

GradientSearch::GradientSearch(std::vector<Axis> axes, GradientOptions options)
    : Search(std::move(axes), options.limits), options_(options) {
    here_.x = start();
    for (const Axis& axis : this->axes()) last_move_.push_back(axis.step);
}

double GradientSearch::difference(std::size_t i) const {
    const Axis& axis = axes()[i];
    return options_.difference > 0 ? options_.difference * axis.step : std::max(1e-5 * axis.step, axis.smallest());
}

std::vector<Point> GradientSearch::around(const Point& x) const {
    std::vector<Point> out;
    for (std::size_t i = 0; i < x.size(); ++i)
        for (const double side : {-1.0, 1.0}) {
            Point beside = x;
            beside[i] += side * difference(i);
            out.push_back(clamped(beside));
        }
    return out;
}

Task<bool> GradientSearch::begin() {
    co_await look(here_);
    if (here_.f.is_measured()) co_return true;
    end(StopKind::failed, "failures", "the start had no value");
    co_return false;
}

// A neighbour without a value leaves the difference to the other one.
Task<void> GradientSearch::look(Iterate& iterate) {
    std::vector<Point> points = around(iterate.x);
    const bool known = !iterate.f.is_failed();
    if (!known) points.push_back(iterate.x);
    const std::vector<Value> values = co_await evaluate(points);
    if (!known) iterate.f = values.back();
    iterate.gradient.assign(dimensions(), 0.0);
    for (std::size_t i = 0; i < dimensions(); ++i) {
        struct Side {
            double x;
            Value f;
        };
        Side below{points[2 * i][i], values[2 * i]}, above{points[2 * i + 1][i], values[2 * i + 1]};
        const Side middle{iterate.x[i], iterate.f};
        if (!below.f.is_measured()) below = middle;
        if (!above.f.is_measured()) above = middle;
        if (below.f.is_measured() && above.f.is_measured() && above.x > below.x)
            iterate.gradient[i] = (above.f.value() - below.f.value()) / (above.x - below.x) * axes()[i].step;
        // Beyond a bound there is nothing to go down to.
        if (iterate.x[i] == (iterate.gradient[i] > 0 ? axes()[i].lower : axes()[i].upper)) iterate.gradient[i] = 0;
    }
}

Task<Value> GradientSearch::value_at(Point x) {
    trial_ = x;
    std::vector<Point> points(1, x);
    const std::vector<Value> values = co_await evaluate(points);
    trial_.reset();
    co_return values[0];
}

Point GradientSearch::moved(const Point& from, const std::vector<double>& direction, double length) const {
    Point x = from;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += length * direction[i] * axes()[i].step;
    return clamped(x);
}

double GradientSearch::distance_in_steps(const Point& x) const {
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += std::pow((x[i] - axes()[i].start) / axes()[i].step, 2);
    return std::sqrt(sum);
}

bool GradientSearch::matters(const std::vector<double>& direction, double length) const {
    for (std::size_t i = 0; i < direction.size(); ++i)
        if (std::abs(length * direction[i]) * axes()[i].step > axes()[i].smallest()) return true;
    return false;
}

void GradientSearch::go_to(const Point& x, Value f) {
    for (std::size_t i = 0; i < x.size(); ++i) last_move_[i] = std::abs(x[i] - here_.x[i]);
    here_.x = x;
    here_.f = f;
}

Task<double> GradientSearch::line_search(const std::vector<double>& direction, double first, bool refined) {
    const double f0 = here_.f.value(), slope = dot(here_.gradient, direction);
    const Point from = here_.x;
    double t = first;
    for (int trial = 0; trial < most_trials && matters(direction, t); ++trial) {
        const Point x = moved(from, direction, t);
        const Value f = co_await value_at(x);
        const auto least = vertex(f0, slope, t, f);
        if (f.is_measured() && f.value() <= f0 + enough * t * slope) {
            go_to(x, f);
            const double longest = std::max(4 * t, 10 / norm(direction)); // ten steps
            const double better = std::min(least.value_or(longest), longest);
            if (!refined || std::abs(better - t) < 1e-3 * t) co_return t;
            const Point y = moved(from, direction, better);
            const Value g = co_await value_at(y);
            if (!g.is_measured() || !(g < f)) co_return t;
            here_.x = from; // the move is counted from there
            go_to(y, g);
            co_return better;
        }
        t = std::clamp(least.value_or(0.5 * t), 0.1 * t, 0.5 * t);
    }
    co_return 0;
}

std::vector<double> GradientSearch::downhill() const {
    std::vector<double> out(here_.gradient);
    for (double& c : out) c = -c;
    return out;
}

bool GradientSearch::has_converged() {
    bool small = true;
    for (std::size_t i = 0; i < dimensions(); ++i) small = small && last_move_[i] <= axes()[i].smallest();
    if (small) {
        end(StopKind::converged, "tolx", "the last move was below the tolerance on every axis");
    } else if (norm(here_.gradient) == 0) {
        end(StopKind::converged, "gradient", "the differences to all neighbours vanish");
    }
    return stopped().has_value();
}

void GradientSearch::end_without_descent() {
    end(StopKind::stalled, "nodescent", "no step along minus the gradient that is long enough to matter is downhill");
}

std::vector<Point> GradientSearch::speculate() const { return trial_ ? around(*trial_) : std::vector<Point>(); }

} // namespace treacle::search
