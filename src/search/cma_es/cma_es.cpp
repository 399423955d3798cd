#include "search/cma_es/cma_es.hpp"

#include <cmath>

namespace treacle::search {

namespace {
constexpr std::uint32_t most_draws = 100;

CmaState fresh_state(std::vector<double> mean, const CmaOptions& options, int restart) {
    const std::size_t n = mean.size();
    const std::size_t first = options.population > 0 ? options.population : CmaConstants::standard_population(n);
    return {std::move(mean), 1.0, CmaConstants::standard(n, first << restart, options.active)};
}
} // namespace

CmaOptions CmaOptions::dissertation(std::uint64_t seed) {
    CmaOptions out;
    out.seed = seed;
    out.active = false;
    out.bounds = BoundHandling::resample;
    out.limits.generations = 80;
    return out;
}

CmaEs::CmaEs(std::vector<Axis> axes, CmaOptions options)
    : Search(std::move(axes), options.limits), options_(options), random_(options.seed), box_(this->axes()),
      origin_(options.bounds == BoundHandling::transform ? box_.preimage(start()) : start()),
      state_(fresh_state(std::vector<double>(dimensions(), 0.0), options_, 0)) {}

Task<void> CmaEs::method() {
    for (;;) {
        Stop stop = co_await run();
        keep_run();
        if (restarts_ == options_.restarts || stop.kind == StopKind::failed) {
            if (restarts_ > 0) stop.text += ", after " + std::to_string(restarts_) + " restarts";
            end(stop.kind, stop.name, stop.text);
            co_return;
        }
        ++restarts_;
        forget();
        begin_run();
    }
}

// A run begins anywhere within the bounds; on axes without both, within a step of the start.
void CmaEs::begin_run() {
    Point x = start();
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Axis& axis = axes()[i];
        const double u = random_.uniform(Purpose::start, generation_, 0, static_cast<std::uint32_t>(i));
        const bool bounded = std::isfinite(axis.lower) && std::isfinite(axis.upper);
        x[i] = bounded ? axis.lower + u * (axis.upper - axis.lower) : x[i] + (2 * u - 1) * axis.step;
    }
    state_ = fresh_state(state_coordinates(clamped(x)), options_, restarts_);
    cut_ = std::numeric_limits<double>::infinity();
}

Task<Stop> CmaEs::run() {
    std::vector<double> tolerances;
    for (const Axis& axis : axes()) tolerances.push_back(axis.smallest() / axis.step);
    CmaStops stops(options_.tolerances, tolerances);
    for (;;) {
        std::vector<std::vector<double>> candidates;
        for (std::uint32_t k = 0; k < state_.constants().lambda; ++k) candidates.push_back(drawn(k));
        if (const auto suggested = suggestion()) candidates[0] = *suggested;
        const std::vector<Value> values = co_await values_of(candidates);
        ++generation_;
        bool any = false;
        for (const Value& value : values) any = any || !value.is_failed();
        if (!any) co_return Stop{StopKind::failed, "failures", "no candidate of a generation had a value"};
        learn(candidates, values);
        if (auto stop = stops.after(state_, values)) co_return *stop;
    }
}

Task<std::vector<Value>> CmaEs::values_of(const std::vector<std::vector<double>>& candidates) {
    std::vector<Point> points;
    points.reserve(candidates.size());
    for (const auto& y : candidates) points.push_back(seen(y));
    std::vector<Value> values = co_await evaluate(points);
    co_return values;
}

void CmaEs::learn(const std::vector<std::vector<double>>& candidates, std::span<const Value> values) {
    const auto order = ranking(values);
    std::vector<std::vector<double>> ranked;
    std::size_t valued = 0, measured = 0;
    cut_ = std::numeric_limits<double>::infinity();
    for (const std::size_t k : order) {
        ranked.push_back(candidates[k]);
        if (!values[k].is_failed()) ++valued;
        if (!values[k].is_measured()) continue;
        if (++measured == state_.constants().mu) cut_ = values[k].value();
    }
    state_.update(ranked, valued);
}

std::vector<double> CmaEs::drawn(std::uint32_t candidate) {
    const auto n = static_cast<std::uint32_t>(dimensions());
    std::vector<double> y;
    for (std::uint32_t draw = 0; draw < most_draws; ++draw) {
        std::vector<double> z(n);
        for (std::uint32_t i = 0; i < n; ++i)
            z[i] = random_.normal(Purpose::candidate, generation_, candidate, draw * n + i);
        y = state_.candidate(z);
        if (options_.bounds == BoundHandling::transform || within(seen(y))) return y;
        ++drawn_anew_;
    }
    return state_coordinates(mirrored(seen(y)));
}

// A point beyond a bound as far within it, or on the other bound.
Point CmaEs::mirrored(Point x) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Axis& axis = axes()[i];
        if (x[i] < axis.lower) x[i] = 2 * axis.lower - x[i];
        if (x[i] > axis.upper) x[i] = 2 * axis.upper - x[i];
    }
    return clamped(x);
}

bool CmaEs::within(const Point& x) const { return clamped(x) == x; }

Point CmaEs::seen(const std::vector<double>& y) const {
    Point x(origin_);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += axes()[i].step * y[i];
    return options_.bounds == BoundHandling::transform ? box_.inside(x) : x;
}

std::vector<double> CmaEs::state_coordinates(const Point& x) const {
    std::vector<double> y = options_.bounds == BoundHandling::transform ? box_.preimage(x) : x;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = (y[i] - origin_[i]) / axes()[i].step;
    return y;
}

void CmaEs::keep_run() {
    if (!best() || best()->value >= best_before_) return;
    best_before_ = best()->value;
    best_run_ = state_;
}

// The run with the best value, be it the present one.
const CmaState& CmaEs::reported() const { return best_run_ && best()->value >= best_before_ ? *best_run_ : state_; }

Point CmaEs::centre() const { return clamped(seen(reported().mean())); }

Point CmaEs::spread() const {
    const CmaState& state = reported();
    Point out(dimensions());
    for (std::size_t i = 0; i < out.size(); ++i) {
        auto high = state.mean(), low = high;
        high[i] += state.deviation(i);
        low[i] -= state.deviation(i);
        out[i] = 0.5 * std::abs(seen(high)[i] - seen(low)[i]);
    }
    return out;
}

} // namespace treacle::search
