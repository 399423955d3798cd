#include "search/gradient/gradient_methods.hpp"

#include "search/problem/matrix.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
constexpr double farthest = 1e4; // steps from the start

// A first trial is no longer than one step.
double first_length(const std::vector<double>& direction) {
    const double length = norm(direction);
    return length > 1 ? 1 / length : 1;
}

double polak_ribiere(std::span<const double> now, std::span<const double> before) {
    double along = 0;
    for (std::size_t i = 0; i < now.size(); ++i) along += now[i] * (now[i] - before[i]);
    return std::max(0.0, along / dot(before, before));
}
} // namespace

Task<void> Lbfgs::method() {
    const bool begun = co_await begin();
    if (!begun) co_return;
    while (!has_converged()) {
        const auto p = direction();
        const Iterate before = here_;
        const double taken = co_await line_search(p, pairs_.empty() ? first_length(p) : 1.0, false);
        if (taken > 0) {
            co_await look(here_);
            remember(before);
        } else if (pairs_.empty()) {
            end_without_descent();
            co_return;
        } else {
            pairs_.clear(); // and once more along the gradient itself
        }
    }
}

std::vector<double> Lbfgs::direction() const {
    auto p = downhill();
    std::vector<double> coefficients;
    for (auto pair = pairs_.rbegin(); pair != pairs_.rend(); ++pair) {
        const double coefficient = dot(pair->move, p) / pair->along;
        coefficients.push_back(coefficient);
        for (std::size_t i = 0; i < p.size(); ++i) p[i] -= coefficient * pair->change[i];
    }
    if (!pairs_.empty()) {
        const Pair& newest = pairs_.back();
        for (double& c : p) c *= newest.along / dot(newest.change, newest.change);
    }
    for (const Pair& pair : pairs_) {
        const double coefficient = coefficients.back() - dot(pair.change, p) / pair.along;
        coefficients.pop_back();
        for (std::size_t i = 0; i < p.size(); ++i) p[i] += coefficient * pair.move[i];
    }
    return p;
}

void Lbfgs::remember(const Iterate& before) {
    Pair pair;
    for (std::size_t i = 0; i < dimensions(); ++i) {
        pair.move.push_back((here_.x[i] - before.x[i]) / axes()[i].step);
        pair.change.push_back(here_.gradient[i] - before.gradient[i]);
    }
    pair.along = dot(pair.move, pair.change);
    if (pair.along <= 1e-10 * norm(pair.move) * norm(pair.change)) return; // no curvature that a minimum has
    pairs_.push_back(pair);
    if (pairs_.size() > options().memory) pairs_.pop_front();
}

Task<void> ConjugateGradients::method() {
    const bool begun = co_await begin();
    if (!begun) co_return;
    auto p = downhill();
    double length = first_length(p);
    bool along_gradient = true;
    while (!has_converged()) {
        const auto before = here_.gradient;
        const double slope = dot(before, p);
        const double taken = co_await line_search(p, length, true);
        if (taken == 0 && along_gradient) {
            end_without_descent();
            co_return;
        }
        if (taken > 0) co_await look(here_);
        auto next = downhill();
        const double beta = taken > 0 ? polak_ribiere(here_.gradient, before) : 0;
        for (std::size_t i = 0; i < p.size(); ++i) next[i] += beta * p[i];
        along_gradient = beta == 0 || dot(here_.gradient, next) >= 0;
        p = along_gradient ? downhill() : next;
        // The first trial has the predicted descent of the last step (Nocedal & Wright, 3.5).
        length = taken > 0 ? std::min(taken * slope / dot(here_.gradient, p), 10 * first_length(p)) : first_length(p);
    }
}

Task<void> MomentumDescent::method() {
    const bool begun = co_await begin();
    if (!begun) co_return;
    const double rate = options().rate / std::max(1e-300, norm(here_.gradient));
    std::vector<double> move(dimensions(), 0.0);
    while (!has_converged()) {
        for (std::size_t i = 0; i < move.size(); ++i) move[i] = options().momentum * move[i] - rate * here_.gradient[i];
        Iterate next;
        next.x = moved(here_.x, move, 1);
        for (std::size_t i = 0; i < move.size(); ++i) {
            move[i] = (next.x[i] - here_.x[i]) / axes()[i].step; // a bound takes the rest away
        }
        co_await look(next);
        if (!next.f.is_measured()) {
            end(StopKind::failed, "failures", "the place that the descent has come to has no value");
            co_return;
        }
        if (distance_in_steps(next.x) > farthest) {
            end(StopKind::stalled, "growth", "the descent has left the start far behind: its rate is too large");
            co_return;
        }
        here_ = next;
        // The move is zero where it turns round, but not for long: what the gradient adds counts as well.
        for (std::size_t i = 0; i < move.size(); ++i)
            last_move_[i] = std::max(std::abs(move[i]), rate * std::abs(here_.gradient[i])) * axes()[i].step;
    }
}

} // namespace treacle::search
