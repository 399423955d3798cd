#include "search/population/surrogate_search.hpp"

#include "search/population/nelder_mead.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
constexpr std::uint32_t draws_per_axis = 150;
constexpr std::uint32_t most_batches_without_fit = 6;
constexpr double half_width = 2; // steps of the first batch and of wide draws where there is no bound
} // namespace

SurrogateSearch::SurrogateSearch(std::vector<Axis> axes, SurrogateOptions options)
    : Search(std::move(axes), options.limits), options_(options), random_(options.seed), centre_(start()) {
    if (options_.first == 0) options_.first = 2 * dimensions() + 2;
    for (const Axis& axis : this->axes()) last_.push_back(axis.start + axis.step);
}

Task<void> SurrogateSearch::method() {
    std::vector<Point> points = hypercube(start(), half_width);
    for (;;) {
        const std::vector<Value> values = co_await evaluate(points);
        take(points, values);
        ++batches_;
        const bool too_few = values_.size() < dimensions() + 2; // for a fit
        if (too_few && (values_.empty() || batches_ > most_batches_without_fit)) {
            end(StopKind::failed, "failures", "too few points around the start had a value");
            co_return;
        }
        if (too_few) { // nearer to the best
            if (best()) centre_ = best()->point;
            points = hypercube(centre_, half_width * std::pow(0.5, batches_));
            continue;
        }
        fit();
        points = next_points();
        if (points.empty()) {
            end(StopKind::converged, "improvement",
                "no improvement worth a run is expected anywhere farther than the tolerance from what was measured");
            co_return;
        }
        last_ = points[0];
    }
}

// A place and a Latin hypercube within some steps of it: each axis is cut into as many parts as there are points, and each
// part is used once.
std::vector<Point> SurrogateSearch::hypercube(const Point& middle, double steps) const {
    const std::size_t count = options_.first - 1;
    std::vector<Point> out(options_.first, middle);
    for (std::uint32_t i = 0; i < dimensions(); ++i) {
        std::vector<Value> keys;
        for (std::uint32_t k = 0; k < count; ++k)
            keys.push_back(Value::measured(random_.uniform(Purpose::start, 2 * batches_, k, i)));
        const auto order = ranking(keys);
        for (std::uint32_t k = 0; k < count; ++k) {
            const double fraction =
                (double(order[k]) + random_.uniform(Purpose::start, 2 * batches_ + 1, k, i)) / double(count);
            out[k + 1][i] += steps * axes()[i].step * (2 * fraction - 1);
        }
    }
    for (Point& x : out) x = clamped(x);
    if (batches_ > 0) out.erase(out.begin()); // the middle is known
    return out;
}

// None where no expected improvement is large enough.
std::vector<Point> SurrogateSearch::next_points() const {
    std::vector<Point> out;
    GaussianProcess model = with_believed();
    const auto [least, most] = std::minmax_element(values_.begin(), values_.end());
    for (std::size_t k = 0; k < options_.batch; ++k) {
        const Choice next = choose(model, static_cast<std::uint32_t>(k));
        if (is_known(next.x) || next.improvement <= options_.improvement * (*most - *least)) break;
        out.push_back(next.x);
        model.believe(scaled(next.x), model.at(scaled(next.x)).mean);
    }
    return out;
}

void SurrogateSearch::take(const std::vector<Point>& points, std::span<const Value> values) {
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (values[k].is_measured()) {
            measured_.push_back(points[k]);
            values_.push_back(values[k].value());
        } else {
            others_.push_back(points[k]);
            other_values_.push_back(values[k]);
        }
    }
}

std::vector<double> SurrogateSearch::scaled(const Point& x) const {
    std::vector<double> out(x);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = (out[i] - axes()[i].start) / axes()[i].step;
    return out;
}

void SurrogateSearch::fit() {
    std::vector<std::vector<double>> points;
    for (const Point& x : measured_) points.push_back(scaled(x));
    model_.emplace(std::move(points), values_);
    double least = std::numeric_limits<double>::infinity();
    for (const Point& x : measured_) {
        const double mean = model_->at(scaled(x)).mean;
        if (mean >= least) continue;
        least = mean;
        centre_ = x;
    }
}

GaussianProcess SurrogateSearch::with_believed() const {
    GaussianProcess out = *model_;
    const double worst = *std::max_element(values_.begin(), values_.end());
    for (std::size_t k = 0; k < others_.size(); ++k) {
        const auto x = scaled(others_[k]);
        const double least = other_values_[k].is_failed() ? worst : other_values_[k].value();
        out.believe(x, std::max(out.at(x).mean, least));
    }
    return out;
}

// (E1) with u = (least - mean) / deviation: deviation (u F(u) + f(u)); the least is that of the model, which noise does not lower.
double SurrogateSearch::expected_improvement(const GaussianProcess& model, const Point& x) const {
    const auto [mean, deviation] = model.at(scaled(x));
    if (!(deviation > 0)) return 0;
    const double u = (model_->at(scaled(centre_)).mean - mean) / deviation;
    return deviation * (u * normal_distribution(u) + normal_density(u));
}

// Domain in which a model without points beyond is valid: the bounds, or within some steps of the start and the centre.
std::vector<Axis> SurrogateSearch::domain() const {
    auto out = axes();
    for (std::size_t i = 0; i < out.size(); ++i) {
        Axis& axis = out[i];
        if (!std::isfinite(axis.lower)) axis.lower = std::min(axis.start, centre_[i]) - half_width * axis.step;
        if (!std::isfinite(axis.upper)) axis.upper = std::max(axis.start, centre_[i]) + half_width * axis.step;
    }
    return out;
}

// Every second draw is anywhere, the others are around the centre, ever nearer.
Point SurrogateSearch::drawn(const std::vector<Axis>& within, std::uint32_t number, std::uint32_t k) const {
    Point x(dimensions());
    const std::uint32_t generation = 1000 * (batches_ + 1) + number; // batches of less than a thousand points
    for (std::uint32_t i = 0; i < x.size(); ++i) {
        const Axis& axis = within[i];
        if (k % 2 == 0) {
            x[i] = axis.lower + (axis.upper - axis.lower) * random_.uniform(Purpose::model, generation, k, i);
        } else {
            const double near = std::pow(10.0, -double(k / 2 % 4)) * model_->lengths()[i] * axis.step;
            x[i] = centre_[i] + near * random_.normal(Purpose::model, generation, k, i);
        }
        x[i] = std::clamp(x[i], axis.lower, axis.upper);
    }
    return x;
}

SurrogateSearch::Choice SurrogateSearch::choose(const GaussianProcess& model, std::uint32_t number) const {
    Choice best{centre_, 0};
    const auto within = domain();
    const auto draws = draws_per_axis * static_cast<std::uint32_t>(dimensions());
    for (std::uint32_t k = 0; k < draws; ++k) {
        const Point x = drawn(within, number, k);
        if (const double value = expected_improvement(model, x); value > best.improvement) best = {x, value};
    }
    const Point x = refined(model, best.x);
    if (const double value = expected_improvement(model, x); value > best.improvement) best = {x, value};
    return best;
}

Point SurrogateSearch::refined(const GaussianProcess& model, const Point& from) const {
    auto near = domain();
    for (std::size_t i = 0; i < near.size(); ++i) {
        near[i].start = from[i];
        near[i].step *= 0.1 * model.lengths()[i];
        near[i].tolerance = std::max(0.1 * axes()[i].smallest(), 1e-6 * axes()[i].step);
    }
    NelderMead search(near, {.limits = {.evaluations = std::int64_t(80 * dimensions())}});
    while (!search.stopped()) {
        std::vector<Value> values;
        for (const Point& x : search.ask()) values.push_back(Value::measured(-expected_improvement(model, x)));
        if (!values.empty()) search.tell(values);
    }
    return search.best()->point;
}

bool SurrogateSearch::is_known(const Point& x) const {
    const auto near = [&](const Point& known) {
        for (std::size_t i = 0; i < x.size(); ++i)
            if (std::abs(x[i] - known[i]) > axes()[i].smallest()) return false;
        return true;
    };
    return std::any_of(measured_.begin(), measured_.end(), near) || std::any_of(others_.begin(), others_.end(), near);
}

Point SurrogateSearch::centre() const { return centre_; }

Point SurrogateSearch::spread() const {
    Point out(dimensions());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::abs(last_[i] - centre_[i]);
    return out;
}

} // namespace treacle::search
