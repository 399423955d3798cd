#include "search/problem/search.hpp"

#include "base/text/contract.hpp"
#include "base/text/error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace treacle::search {

namespace {
std::vector<Diagnostic> problems(const std::vector<Axis>& axes) {
    std::vector<Diagnostic> found;
    if (axes.empty())
        found.push_back({"", "a search has no axis", "there is nothing to look for", "give it a parameter"});
    for (std::size_t i = 0; i < axes.size(); ++i) {
        const auto& axis = axes[i];
        const std::string where = "axis " + std::to_string(i + 1);
        if (!(axis.lower < axis.upper))
            found.push_back({where, "its lower bound is not below its upper one", "no value is between them", ""});
        if (!(axis.lower <= axis.start && axis.start <= axis.upper) || !std::isfinite(axis.start))
            found.push_back({where, "its start is not within its bounds", "the search begins there", ""});
        if (!(axis.step > 0) || !std::isfinite(axis.step))
            found.push_back({where, "its step is not positive", "it is the standard deviation around the start",
                "a quarter of the range is a good one"});
    }
    return found;
}
} // namespace

Value Value::measured(double value) {
    Value out;
    if (!std::isfinite(value)) return out;
    out.kind_ = Kind::measured;
    out.value_ = value;
    return out;
}

Value Value::at_least(double bound) {
    Value out;
    if (!std::isfinite(bound)) return out;
    out.kind_ = Kind::at_least;
    out.value_ = bound;
    return out;
}

bool Value::operator<(const Value& other) const {
    if (value_ != other.value_) return value_ < other.value_;
    return kind_ < other.kind_;
}

std::vector<std::size_t> ranking(std::span<const Value> values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    return order;
}

Search::Search(std::vector<Axis> axes, const Limits& limits) : axes_(std::move(axes)), limits_(limits) {
    if (auto found = problems(axes_); !found.empty()) throw InputError(std::move(found));
}

const std::vector<Point>& Search::ask() {
    if (!task_ && !stop_) {
        task_.emplace(method());
        waiting_ = nullptr;
        task_->start();
        advance();
    }
    return points_;
}

void Search::tell(std::span<const Value> values) {
    TREACLE_EXPECT(task_ && !stop_ && values.size() == points_.size());
    for (std::size_t k = 0; k < values.size(); ++k)
        if (values[k].is_measured() && (!best_ || values[k].value() < best_->value))
            best_ = Best{points_[k], values[k].value(), evaluations_ + static_cast<std::int64_t>(k)};
    evaluations_ += static_cast<std::int64_t>(values.size());
    ++generations_;
    values_.assign(values.begin(), values.end());
    points_.clear();
    std::exchange(waiting_, nullptr).resume();
    advance();
}

// The method is suspended until values arrive, or has ended.
void Search::advance() {
    if (task_->done()) task_->check();
    TREACLE_ENSURE(stop_ || !points_.empty());
    look_at_limits();
    if (stop_) points_.clear();
}

void Search::look_at_limits() {
    if (best_ && best_->value <= limits_.target) {
        stop_.reset(); // a search that reached its target and stalled has reached it
        end(StopKind::target, "target", "the best value is at or below the one asked for");
    } else if (!stop_ && static_cast<std::int64_t>(points_.size()) > limits_.evaluations - evaluations_) {
        end(StopKind::budget, "evaluations",
            "the next " + std::to_string(points_.size()) + " evaluations are more than the budget of " +
                std::to_string(limits_.evaluations) + " has left");
    } else if (!stop_ && generations_ >= limits_.generations) {
        end(StopKind::budget, "generations",
            "the budget of " + std::to_string(limits_.generations) + " generations is used up");
    }
}

void Search::end(StopKind kind, std::string name, std::string text) {
    if (!stop_) stop_ = Stop{kind, std::move(name), std::move(text)};
}

Search::Evaluation Search::evaluate(std::vector<Point> points) {
    points_ = std::move(points);
    return Evaluation(*this);
}

Point Search::centre() const { return best_ ? best_->point : start(); }

Point Search::start() const {
    Point out;
    for (const auto& axis : axes_) out.push_back(axis.start);
    return out;
}

Point Search::clamped(Point point) const {
    for (std::size_t i = 0; i < point.size(); ++i) point[i] = std::clamp(point[i], axes_[i].lower, axes_[i].upper);
    return point;
}

} // namespace treacle::search
