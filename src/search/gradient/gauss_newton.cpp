#include "search/gradient/gauss_newton.hpp"

#include "base/text/contract.hpp"
#include "search/gradient/bounded_move.hpp"
#include "search/problem/huber.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
constexpr double first_difference = 0.4; // steps
constexpr double beside = 0.25;          // steps to a point that determines derivatives
constexpr double curved = 0.2;           // steps from where on curvature spoils a difference more than noise does
constexpr double memory = 1e-4;          // weight of the derivatives of before
constexpr double known_enough = 3e-3,
                 known_well = 0.01; // of the sum of weights and squared distances: a point at 0.7, and 0.4 steps
constexpr double least_radius = 0.02, most_radius = 4;
constexpr int most_idle = 3;
constexpr int reweightings = 12;

double squared(double x) { return x * x; }
} // namespace

GaussNewton::GaussNewton(std::vector<Axis> axes, GaussNewtonOptions options)
    : Search(std::move(axes), options.limits), options_(options) {}

Task<void> GaussNewton::method() {
    co_await gather(first_points());
    while (!stopped()) {
        if (trials_.empty()) {
            end(StopKind::failed, "failures", "the start and the points beside it had no value");
            break;
        }
        update_model();
        const Move move = best_move(radius_);
        const Trial before = best_trial();
        const std::size_t first_new = trials_.size();
        if (has_settled(move)) {
            auto unknown = unknown_beside(before.x, known_enough);
            if (unknown.empty() || idle_ >= most_idle) {
                end_settled(move);
                break;
            }
            co_await gather(std::move(unknown));
            if (trials_.size() == first_new) ++idle_;
            continue;
        }
        std::vector<Point> points{moved(before.x, move.d)};
        if (move.binding && idle_ == 0) {
            points.push_back(moved(before.x, best_move(std::min(2 * radius_, most_radius)).d));
        } else if (const auto unknown = unknown_beside(points.front(), known_well); !unknown.empty()) {
            points.push_back(unknown.front());
        }
        if (points.size() > 1 && points[1] == points[0]) points.pop_back();
        co_await gather(std::move(points));
        adapt_radius(move, before, first_new);
    }
}

Task<void> GaussNewton::gather(std::vector<Point> points) {
    const auto asked = points;
    const std::vector<Value> values = co_await evaluate(std::move(points));
    TREACLE_EXPECT(told_.size() == asked.size());
    numbers_.clear();
    for (std::size_t k = 0; k < asked.size(); ++k) {
        const bool measured = values[k].is_measured() && !told_[k].empty();
        numbers_.push_back(measured ? trials_.size() : std::size_t(-1));
        if (measured) trials_.push_back({asked[k], values[k].value(), std::move(told_[k])});
    }
    told_.clear();
}

std::vector<Point> GaussNewton::first_points() const {
    std::vector<Point> out{start()};
    for (std::size_t k = 0; k < dimensions(); ++k) {
        const auto& axis = axes()[k];
        const double away = axis.upper - axis.start >= axis.start - axis.lower ? 1 : -1; // to where there is more room
        out.push_back(start());
        out.back()[k] += away * first_difference * axis.step;
        out.back() = clamped(out.back());
    }
    return out;
}

const GaussNewton::Trial& GaussNewton::best_trial() const {
    return *std::ranges::min_element(trials_, {}, &Trial::value);
}

std::vector<double> GaussNewton::in_steps(const Point& from, const Point& to) const {
    std::vector<double> out;
    for (std::size_t k = 0; k < from.size(); ++k) out.push_back((to[k] - from[k]) / axes()[k].step);
    return out;
}

Point GaussNewton::moved(const Point& x, std::span<const double> d) const {
    Point out = x;
    for (std::size_t k = 0; k < x.size(); ++k) out[k] += d[k] * axes()[k].step;
    return clamped(out);
}

// (N2) J + (Y - J D) W D^T (D W D^T + memory)^-1, D the ways from the best point, Y the changes of the residuals.
void GaussNewton::update_model() {
    const std::size_t n = dimensions();
    const Trial& best = best_trial();
    const std::size_t rows = best.residuals.size();
    if (j_.rows() != rows) j_ = Matrix(rows, n);
    r_ = best.residuals;
    Matrix ways(trials_.size(), n); // times W
    known_ = Matrix(n, n);
    std::vector<std::vector<double>> d;
    for (std::size_t t = 0; t < trials_.size(); ++t) {
        d.push_back(in_steps(best.x, trials_[t].x));
        const double weight = 1 / (1 + squared(dot(d[t], d[t]) / squared(curved)));
        for (std::size_t a = 0; a < n; ++a) {
            ways(t, a) = weight * d[t][a];
            for (std::size_t b = 0; b < n; ++b) known_(a, b) += weight * d[t][a] * d[t][b];
        }
    }
    Matrix regular = known_;
    for (std::size_t a = 0; a < n; ++a) regular(a, a) += memory;
    const auto l = cholesky(regular);
    for (std::size_t i = 0; i < rows; ++i) {
        std::vector<double> beyond(n, 0.0); // (Y - J D) W D^T
        bool whole = std::isfinite(best.residuals[i]);
        for (std::size_t t = 0; whole && t < trials_.size(); ++t) {
            const double change = trials_[t].residuals[i] - best.residuals[i];
            // A row that the run near by does not have is left out; farther runs then have no effect on it.
            if (!std::isfinite(change)) {
                whole = norm(d[t]) > 1;
                continue;
            }
            const double rest = change - dot(j_.row(i), d[t]);
            for (std::size_t a = 0; a < n; ++a) beyond[a] += rest * ways(t, a);
        }
        if (!whole) r_[i] = 0;
        const auto correction = solve_lower_transposed(*l, solve_lower(*l, beyond));
        for (std::size_t a = 0; a < n; ++a) j_(i, a) = whole ? j_(i, a) + correction[a] : 0;
    }
}

double GaussNewton::worth(double value) const { return options_.flat * std::max(1.0, options_.noise / value); }

double GaussNewton::loss(std::span<const double> d) const {
    double sum = 0;
    for (std::size_t i = 0; i < r_.size(); ++i) {
        sum += huber_loss(r_[i] + dot(j_.row(i), d), options_.bend);
    }
    return sum;
}

// J^T W J and J^T W r with the weights of Huber where the move leads.
Matrix GaussNewton::normal_equations(std::span<const double> d, std::vector<double>& slope) const {
    const std::size_t n = dimensions();
    Matrix out(n, n);
    slope.assign(n, 0.0);
    for (std::size_t i = 0; i < r_.size(); ++i) {
        const auto row = j_.row(i);
        const double u = std::abs(r_[i] + dot(row, d)), weight = u <= options_.bend ? 1 : options_.bend / u;
        for (std::size_t a = 0; a < n; ++a) {
            slope[a] += weight * row[a] * r_[i];
            for (std::size_t b = 0; b < n; ++b) out(a, b) += weight * row[a] * row[b];
        }
    }
    return out;
}

// (N1) least sum of Huber's loss of r + J d and of flat |d|^2 sum loss(r), |d| <= radius, within the bounds.
GaussNewton::Move GaussNewton::best_move(double radius) const {
    const std::size_t n = dimensions();
    const Point& here = best_trial().x;
    Room room{std::vector<double>(n), std::vector<double>(n), radius};
    for (std::size_t k = 0; k < n; ++k) {
        room.lower[k] = (axes()[k].lower - here[k]) / axes()[k].step;
        room.upper[k] = (axes()[k].upper - here[k]) / axes()[k].step;
    }
    Move out;
    out.d.assign(n, 0.0);
    const double whole = loss(out.d);
    std::vector<double> slope;
    for (int round = 0; round < reweightings; ++round) {
        Matrix normal = normal_equations(out.d, slope);
        for (std::size_t k = 0; k < n; ++k) normal(k, k) += 2 * options_.flat * whole;
        out.d = bounded_move(normal, slope, room);
    }
    out.gain = whole > 0 ? 1 - loss(out.d) / whole : 0;
    out.binding = norm(out.d) > 0.99 * radius;
    return out;
}

std::vector<Point> GaussNewton::unknown_beside(const Point& x, double least) const {
    const auto eigen = symmetric_eigen(known_);
    std::vector<Point> out;
    for (std::size_t k = 0; k < dimensions() && eigen.values[k] < least; ++k) {
        std::vector<double> way(dimensions());
        for (std::size_t a = 0; a < way.size(); ++a) way[a] = beside * eigen.vectors(a, k);
        auto there = moved(x, way);
        for (double& one : way) one = -one;
        const auto back = moved(x, way);
        if (norm(in_steps(x, back)) > norm(in_steps(x, there))) there = back; // at a bound
        if (there != x) out.push_back(there);
    }
    return out;
}

bool GaussNewton::has_settled(const Move& move) const {
    bool small = true;
    for (std::size_t k = 0; k < dimensions(); ++k)
        small = small && std::abs(move.d[k]) * axes()[k].step <= axes()[k].smallest();
    return small || move.gain < worth(best_trial().value) || radius_ < least_radius || idle_ >= most_idle;
}

void GaussNewton::end_settled(const Move& move) {
    if (radius_ < least_radius || idle_ >= most_idle) {
        end(StopKind::stalled, "nogain", "the last rounds of runs gained nothing that counts");
    } else if (move.gain < worth(best_trial().value)) {
        end(StopKind::converged, "flat", "no move promises a gain that is worth a run");
    } else {
        end(StopKind::converged, "tolx", "the next move is below the tolerance on every axis");
    }
}

void GaussNewton::adapt_radius(const Move& move, const Trial& before, std::size_t first_new) {
    const bool known = numbers_.front() >= first_new && numbers_.front() < trials_.size();
    const double actual = known && before.value > 0 ? 1 - trials_[numbers_.front()].value / before.value : -1;
    const double length = norm(move.d), gained = before.value > 0 ? 1 - best_trial().value / before.value : 0;
    if (actual < 0.25 * move.gain) {
        radius_ = 0.5 * std::min(radius_, length);
    } else if (actual > 0.7 * move.gain && move.binding) {
        radius_ = std::min(most_radius, 2 * radius_);
    }
    idle_ = gained < worth(before.value) ? idle_ + 1 : 0;
}

Point GaussNewton::spread() const {
    Point out;
    for (const auto& axis : axes()) out.push_back(radius_ * axis.step);
    return out;
}

} // namespace treacle::search
