#include "search/cma_es/cma_stops.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
double range(std::span<const double> values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high - *low;
}

double median(std::span<const double> values) {
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
}

double largest_deviation(const CmaState& state) { return state.sigma() * std::sqrt(state.axes().values.back()); }

bool axis_has_no_effect(const CmaState& state) {
    const std::size_t n = state.mean().size(), j = static_cast<std::size_t>(state.updates()) % n;
    const double length = 0.1 * state.sigma() * std::sqrt(state.axes().values[j]);
    for (std::size_t i = 0; i < n; ++i)
        if (state.mean()[i] + length * state.axes().vectors(i, j) != state.mean()[i]) return false;
    return true;
}

bool coordinate_has_no_effect(const CmaState& state) {
    for (std::size_t i = 0; i < state.mean().size(); ++i)
        if (state.mean()[i] + 0.2 * state.deviation(i) == state.mean()[i]) return true;
    return false;
}
} // namespace

CmaStops::CmaStops(CmaTolerances tolerances, std::vector<double> coordinate_tolerances)
    : tolerances_(tolerances), coordinates_(std::move(coordinate_tolerances)) {}

std::optional<Stop> CmaStops::after(const CmaState& state, std::span<const Value> values) {
    remember(values);
    if (auto stop = of_coordinates(state)) return stop;
    return of_values(state);
}

void CmaStops::remember(std::span<const Value> values) {
    std::vector<double> sorted;
    for (const Value& value : values)
        if (!value.is_failed()) sorted.push_back(value.value());
    if (sorted.empty()) return;
    std::sort(sorted.begin(), sorted.end());
    best_.push_back(sorted.front());
    median_.push_back(sorted[sorted.size() / 2]);
    last_range_ =
        sorted.size() == values.size() ? sorted.back() - sorted.front() : std::numeric_limits<double>::infinity();
}

std::optional<Stop> CmaStops::of_coordinates(const CmaState& state) const {
    bool small = true;
    for (std::size_t i = 0; i < coordinates_.size(); ++i)
        small = small && state.deviation(i) < coordinates_[i] && std::abs(state.path(i)) < coordinates_[i];
    if (small)
        return Stop{StopKind::converged, "tolx", "the spread of candidates is below the tolerance on every axis"};
    const auto& lengths = state.axes().values;
    if (!(lengths.front() > 0) || lengths.back() > tolerances_.condition * lengths.front())
        return Stop{StopKind::stalled, "condition", "the candidates' covariance has become too elongated"};
    if (largest_deviation(state) > tolerances_.growth)
        return Stop{StopKind::stalled, "growth",
            "the spread of candidates has grown without bound: the steps at the start were far too small, or "
            "the objective falls for ever"};
    if (axis_has_no_effect(state))
        return Stop{StopKind::stalled, "noeffectaxis", "a tenth of the spread along an axis is below round-off"};
    if (coordinate_has_no_effect(state))
        return Stop{StopKind::stalled, "noeffectcoord", "a fifth of the spread of a coordinate is below round-off"};
    return std::nullopt;
}

std::optional<Stop> CmaStops::of_values(const CmaState& state) const {
    const auto& c = state.constants();
    const std::size_t generations = 10 + (30 * c.n + c.lambda - 1) / c.lambda;
    if (best_.size() < generations) return std::nullopt;
    const double recent = range(std::span(best_).last(generations));
    if (recent < tolerances_.value_history)
        return Stop{StopKind::converged, "tolfunhist",
            "the best values of the last " + std::to_string(generations) + " generations are the same"};
    if (std::max(recent, last_range_) < tolerances_.value)
        return Stop{StopKind::converged, "tolfun",
            "the values of the last generation and the best ones of the last " + std::to_string(generations) +
                " differ by less than the tolerance"};
    if (stagnates(state))
        return Stop{StopKind::stalled, "stagnation", "neither best nor median values have fallen for a long while"};
    return std::nullopt;
}

// Best and median values of the last 30 % of a long while against those of its first 30 %.
bool CmaStops::stagnates(const CmaState& state) const {
    const auto& c = state.constants();
    const std::size_t least = 120 + 30 * c.n / c.lambda;
    const std::size_t window = std::max(least, best_.size() / 5);
    if (best_.size() < window) return false;
    const std::size_t part = 3 * window / 10;
    const auto no_better = [&](const std::vector<double>& values) {
        const auto recent = std::span(values).last(window);
        return median(recent.last(part)) >= median(recent.first(part));
    };
    return no_better(best_) && no_better(median_);
}

} // namespace treacle::search
