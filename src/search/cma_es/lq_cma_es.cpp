#include "search/cma_es/lq_cma_es.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
constexpr double enough_agreement = 0.85; // Kendall's tau
constexpr std::size_t least_values = 4;   // before the model is used
} // namespace

LqCmaEs::LqCmaEs(std::vector<Axis> axes, CmaOptions options)
    : CmaEs(std::move(axes), options), model_(dimensions(), state().constants().lambda) {}

void LqCmaEs::forget() { model_ = LqModel(dimensions(), 2 * state().constants().lambda); }

std::vector<std::size_t> LqCmaEs::unmeasured_by_model(
    const Candidates& candidates, const std::vector<bool>& measured) const {
    std::vector<Value> expected;
    for (const auto& y : candidates) expected.push_back(Value::measured(model_.at(y)));
    std::vector<std::size_t> out;
    for (const std::size_t k : ranking(expected))
        if (!measured[k]) out.push_back(k);
    return out;
}

Task<std::vector<Value>> LqCmaEs::values_of(const Candidates& candidates) {
    const std::size_t count = candidates.size();
    std::vector<bool> asked(count, false);
    std::vector<std::optional<Value>> values(count);
    std::size_t done = 0, added = 0;
    std::size_t wanted = 1 + std::max(count / 50, least_values - std::min(least_values, model_.size()));
    for (;;) {
        const auto order = unmeasured_by_model(candidates, asked);
        const std::size_t batch = std::min(wanted - done, order.size());
        std::vector<Point> points;
        for (std::size_t k = 0; k < batch; ++k) points.push_back(seen(candidates[order[k]]));
        for (std::size_t k = batch; k < order.size(); ++k) next_.push_back(seen(candidates[order[k]]));
        const std::vector<Value> told = co_await evaluate(points);
        next_.clear();
        for (std::size_t k = 0; k < batch; ++k) {
            asked[order[k]] = true;
            values[order[k]] = told[k];
            if (!told[k].is_measured()) continue;
            model_.add(candidates[order[k]], told[k].value());
            ++added;
        }
        done += batch;
        if (model_.size() > 0) model_.fit(added);
        const auto newest = std::max<std::size_t>(15, std::size_t(std::min(1.2 * double(done), 0.75 * double(count))));
        if (done == count || model_.agreement(newest) >= enough_agreement) break;
        wanted += (wanted + 1) / 2;
    }
    std::vector<Value> out = with_model(candidates, values);
    co_return out;
}

// Measured values where there are no others; else the model's of all, shifted so that the least of them is the least that was
// measured. What failed fails, and a bound holds.
std::vector<Value> LqCmaEs::with_model(
    const Candidates& candidates, const std::vector<std::optional<Value>>& values) const {
    std::vector<Value> out;
    double least = std::numeric_limits<double>::infinity(), least_expected = least;
    bool all = true;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        all = all && values[k];
        least_expected = std::min(least_expected, model_.at(candidates[k]));
        if (values[k] && values[k]->is_measured()) least = std::min(least, values[k]->value());
    }
    const double shift = std::isfinite(least) ? least - least_expected : 0;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        const Value expected = Value::measured(model_.at(candidates[k]) + shift);
        if (all || (values[k] && values[k]->is_failed())) {
            out.push_back(*values[k]);
        } else {
            out.push_back(values[k] && !values[k]->is_measured() ? std::max(*values[k], expected) : expected);
        }
    }
    return out;
}

// The least place of the model, or else a step down its slope; no farther from the mean than candidates get (Hansen 2011,
// injection).
std::optional<std::vector<double>> LqCmaEs::suggestion() const {
    if (model_.size() < least_values) return std::nullopt;
    const CmaState& s = state();
    const double n = double(dimensions());
    auto minimum = model_.minimum();
    if (!minimum) {
        minimum = s.mean();
        const auto slope = multiply(s.covariance(), model_.gradient(s.mean()));
        for (std::size_t i = 0; i < minimum->size(); ++i)
            (*minimum)[i] -= 1e6 * s.sigma() * slope[i] / (norm(slope) + 1e-300);
    }
    const double distance = s.distance(*minimum), farthest = std::sqrt(n) + 2 * n / (n + 2);
    if (!(distance > 0) || !std::isfinite(distance)) return std::nullopt;
    if (distance > farthest)
        for (std::size_t i = 0; i < minimum->size(); ++i)
            (*minimum)[i] = s.mean()[i] + farthest / distance * ((*minimum)[i] - s.mean()[i]);
    return minimum;
}

} // namespace treacle::search
