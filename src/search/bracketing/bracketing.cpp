#include "search/bracketing/bracketing.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
constexpr double growth = 1.618033988749895; // of a step downhill over the one before
constexpr int most_steps_downhill = 40;      // 1e8 steps
constexpr double local = 16;                 // tolerances: the residuals' curve through points as near as this is right

bool by_position(const Sample& a, const Sample& b) { return a.x < b.x; }
} // namespace

Bracketing::Bracketing(const Axis& axis, const Limits& limits) : Search({axis}, limits) {}

Task<void> Bracketing::method() {
    co_await look_around();
    if (samples_[least()].f.is_failed()) {
        end(StopKind::failed, "failures", "neither the start nor its neighbours had a value");
        co_return;
    }
    const bool found = co_await go_downhill();
    if (!found) {
        end(StopKind::stalled, "growth", "the objective falls for ever");
        co_return;
    }
    co_await refine();
    say_converged();
}

Task<void> Bracketing::look_around() {
    const Axis& axis = axes()[0];
    std::vector<Point> points;
    points.push_back({axis.start});
    for (const double x : {axis.start - axis.step, axis.start + axis.step}) {
        const Point point = clamped({x});
        if (point[0] != axis.start) points.push_back(point);
    }
    const std::vector<Value> values = co_await values_of(points);
    for (std::size_t k = 0; k < points.size(); ++k) samples_.push_back({points[k][0], values[k]});
    std::sort(samples_.begin(), samples_.end(), by_position);
}

std::size_t Bracketing::least() const {
    std::vector<Value> values;
    for (const Sample& sample : samples_) values.push_back(sample.f);
    return ranking(values)[0];
}

std::optional<double> Bracketing::further(double before, double from) const {
    const Point x = clamped({from + growth * (from - before)});
    return x[0] == from ? std::nullopt : std::optional(x[0]);
}

// The next step downhill, where the least value is at an end.
std::optional<double> Bracketing::downhill() const {
    const std::size_t last = samples_.size() - 1;
    return least() > 0 ? further(samples_[last - 1].x, samples_[last].x) : further(samples_[1].x, samples_[0].x);
}

// Between a bound that has the least value and the next sample that is not near it: an objective that levels out there may
// have its least value in a gap that a long step went over.
std::optional<double> Bracketing::gap_at_bound() const {
    const double bound = samples_[least()].x;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Sample& sample : samples_)
        if (std::abs(sample.x - bound) > 0.5 * axes()[0].step && std::abs(sample.x - bound) < std::abs(nearest - bound))
            nearest = sample.x;
    return std::isfinite(nearest) ? std::optional(0.5 * (bound + nearest)) : std::nullopt;
}

// True once the least value has neighbours on both sides, or is at a bound.
Task<bool> Bracketing::go_downhill() {
    bool looked_back = false;
    for (int step = 0; step < most_steps_downhill; ++step) {
        const std::size_t at = least();
        if (at > 0 && at + 1 < samples_.size()) co_return true;
        auto x = downhill();
        if (!x && !looked_back) {
            x = gap_at_bound();
            looked_back = true;
        }
        if (!x) co_return true;
        std::vector<Point> points;
        points.push_back({*x});
        const std::vector<Value> values = co_await values_of(points);
        samples_.push_back({*x, values[0]});
        std::sort(samples_.begin(), samples_.end(), by_position);
    }
    co_return false;
}

Task<std::vector<Value>> Bracketing::values_of(std::vector<Point> points) {
    std::vector<Value> values = co_await evaluate(points);
    for (std::size_t k = 0; k < told_.size(); ++k)
        if (values[k].is_measured() && !told_[k].empty()) curve_.add(points[k][0], std::move(told_[k]));
    told_.clear();
    co_return values;
}

std::optional<double> Bracketing::curve_vertex() const {
    const double best = brent_->best().x, width = axes()[0].smallest();
    if (!downhill_ || !curve_.is_known(best)) return std::nullopt;
    return brent_->on_lattice(curve_.least(best, brent_->lower(), brent_->upper(), 0.5 * width));
}

Task<void> Bracketing::refine() {
    brent_.emplace(samples_, axes()[0].smallest(), axes()[0].start);
    while (!brent_->converged()) {
        const auto vertex = curve_vertex();
        const bool there = vertex && std::abs(*vertex - brent_->best().x) <= axes()[0].smallest();
        if (there && led_ && curve_.nearest(brent_->best().x) <= local * axes()[0].smallest()) break;
        const bool use =
            vertex && *vertex > brent_->lower() && *vertex < brent_->upper() && *vertex != brent_->best().x;
        const double before = brent_->best().x, next = use ? *vertex : brent_->next();
        std::vector<Point> points;
        points.push_back({next});
        const std::vector<Value> values = co_await values_of(points);
        use ? brent_->accept(next, values[0]) : brent_->accept(values[0]);
        const bool better = brent_->best().x != before;
        downhill_ = !use || better;
        if (better) led_ = use;
    }
}

void Bracketing::say_converged() {
    const Axis& axis = axes()[0];
    const double x = brent_->best().x;
    // Within the tolerance, for ties.
    for (const auto& [bound, word] : {std::pair(axis.lower, "lower"), std::pair(axis.upper, "upper")})
        if (std::abs(x - bound) <= axis.smallest())
            return end(StopKind::converged, "bound",
                std::string("the least value is at the ") + word + " bound: the answer may lie beyond");
    end(StopKind::converged, "tolx", "the least value is between neighbours within the tolerance");
}

std::vector<Point> Bracketing::speculate() const {
    std::vector<Point> out;
    const auto add = [&](std::optional<double> x) {
        if (x && std::find(out.begin(), out.end(), Point{*x}) == out.end()) out.push_back({*x});
    };
    const auto add_next = [&](const Brent& brent) {
        if (!brent.converged()) add(brent.next());
    };
    if (samples_.empty()) { // the first steps downhill
        const Axis& axis = axes()[0];
        add(further(axis.start, axis.start - axis.step));
        add(further(axis.start, axis.start + axis.step));
    } else if (!brent_) {
        const auto x = downhill();
        if (!x) return out;
        const bool up = least() > 0;
        auto worse = samples_;
        worse.insert(up ? worse.end() : worse.begin(), {*x, Value::failed()});
        add_next(Brent(worse, axes()[0].smallest(), axes()[0].start));
        add(further(up ? samples_.back().x : samples_.front().x, *x));
    } else if (!brent_->converged()) {
        Brent as_expected = *brent_, worse = *brent_;
        as_expected.accept(brent_->expected());
        worse.accept(Value::failed());
        add_next(as_expected);
        add_next(worse);
    }
    return out;
}

Point Bracketing::spread() const {
    if (brent_) return {0.5 * (brent_->upper() - brent_->lower())};
    return {axes()[0].step};
}

} // namespace treacle::search
