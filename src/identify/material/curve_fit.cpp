#include "identify/material/curve_fit.hpp"

#include "search/gradient/bounded_move.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace treacle::identify {

namespace {
constexpr double least_exponent = 0.02, most_exponent = 1.5, yield_fraction_limit = 0.999;
constexpr double beyond = 1.5;    // factor by which points may lie outside of the flow's rates
constexpr std::size_t enough = 4; // points: one more than the law's parameters

struct Points {
    std::vector<double> log_rate, log_viscosity, weight; // weights sum to 1
};

// Weights by the trapezoidal rule in the logarithm of the rate: points that lie close to each other count for less.
Points points_within(const ViscositiesByRate& curve, double from, double to) {
    Points out;
    for (std::size_t i = 0; i < curve.rates.size(); ++i) {
        if (curve.rates[i] < from || curve.rates[i] > to) continue;
        out.log_rate.push_back(std::log(curve.rates[i]));
        out.log_viscosity.push_back(std::log(curve.viscosities[i]));
    }
    const auto n = out.log_rate.size();
    if (n < 2) return out;
    const double whole = out.log_rate.back() - out.log_rate.front();
    for (std::size_t i = 0; i < n; ++i)
        out.weight.push_back(0.5 * (out.log_rate[std::min(i + 1, n - 1)] - out.log_rate[i == 0 ? 0 : i - 1]) / whole);
    return out;
}

// ln eta = level + ln(f / x + (1 - f) x^(n - 1)), x the rate over that in the middle; f, yield_fraction, is the yield stress's of the stress there.
struct Law {
    double level = 0, yield_fraction = 0, exponent = 1;
};

class CurveSquares {
public:
    explicit CurveSquares(Points points) : points_(std::move(points)) {
        for (std::size_t i = 0; i < size(); ++i) middle_ += points_.weight[i] * points_.log_rate[i];
    }
    double middle() const { return middle_; } // of the logarithms of the rates
    std::size_t size() const { return points_.log_rate.size(); }

    double residual(const Law& law, std::size_t i) const {
        return law.level + std::log(shape(law, i)) - points_.log_viscosity[i];
    }
    double sum(const Law& law) const {
        double out = 0;
        for (std::size_t i = 0; i < size(); ++i) out += points_.weight[i] * std::pow(residual(law, i), 2);
        return out;
    }
    // Least along the level, which is linear.
    Law levelled(Law law) const {
        for (std::size_t i = 0; i < size(); ++i) law.level -= points_.weight[i] * residual(law, i);
        return law;
    }
    // Matrix and slope of Gauss and Newton for half the sum, by level, share and exponent.
    void linearise(const Law& law, search::Matrix& a, std::vector<double>& b) const {
        a = search::Matrix(3, 3);
        b.assign(3, 0.0);
        for (std::size_t i = 0; i < size(); ++i) {
            const double x = points_.log_rate[i] - middle_, power = std::exp((law.exponent - 1) * x), s = shape(law, i);
            const std::array<double, 3> slope{1, (std::exp(-x) - power) / s, (1 - law.yield_fraction) * power * x / s};
            for (std::size_t j = 0; j < 3; ++j) {
                b[j] += points_.weight[i] * slope[j] * residual(law, i);
                for (std::size_t k = 0; k < 3; ++k) a(j, k) += points_.weight[i] * slope[j] * slope[k];
            }
        }
    }

private:
    double shape(const Law& law, std::size_t i) const {
        const double x = points_.log_rate[i] - middle_;
        return law.yield_fraction * std::exp(-x) + (1 - law.yield_fraction) * std::exp((law.exponent - 1) * x);
    }

    Points points_;
    double middle_ = 0;
};

// Gauss-Newton within a trust radius.
Law descend(const CurveSquares& squares, Law law, double max_yield_fraction) {
    constexpr int rounds = 200;
    constexpr double smallest = 1e-12;
    constexpr double far = std::numeric_limits<double>::max();
    double radius = 0.5, sum = squares.sum(law);
    search::Matrix a;
    std::vector<double> b;
    for (int round = 0; round < rounds && radius > smallest; ++round) {
        squares.linearise(law, a, b);
        const auto move = search::bounded_move(a, b,
            {{-far, -law.yield_fraction, least_exponent - law.exponent},
                {far, max_yield_fraction - law.yield_fraction, most_exponent - law.exponent}, radius});
        const Law next{law.level + move[0], law.yield_fraction + move[1], law.exponent + move[2]};
        const double there = squares.sum(next);
        if (!(there < sum)) {
            radius /= 4;
            continue;
        }
        const bool settled = search::norm(move) < smallest;
        law = next;
        sum = there;
        radius *= 2;
        if (settled) break;
    }
    return law;
}
} // namespace

double CurveFit::at(double rate) const { return yield_stress / rate + consistency * std::pow(rate, exponent - 1); }

CurveFit fit_flow_curve(const ViscositiesByRate& curve, double from, double to) {
    auto points = points_within(curve, from / beyond, to * beyond);
    if (points.log_rate.size() < enough) points = points_within(curve, 0, std::numeric_limits<double>::infinity());
    CurveFit out;
    out.points = points.log_rate.size();
    out.from = std::exp(points.log_rate.front());
    out.to = std::exp(points.log_rate.back());
    const CurveSquares squares(std::move(points));
    // From several points, since a yield stress and a small exponent have the same effect over a short range.
    const double max_yield_fraction = out.points < enough ? 0 : yield_fraction_limit;
    Law best;
    double least = std::numeric_limits<double>::infinity();
    for (const double exponent : {0.3, 0.7, 1.0}) {
        for (const double yield_fraction : {0.0, 0.3, 0.7}) {
            const auto law = descend(squares,
                squares.levelled({0, std::min(yield_fraction, max_yield_fraction), exponent}), max_yield_fraction);
            if (squares.sum(law) < least) best = law, least = squares.sum(law);
        }
    }
    const double rate = std::exp(squares.middle()), viscosity = std::exp(best.level);
    out.exponent = best.exponent;
    out.consistency = (1 - best.yield_fraction) * viscosity * std::pow(rate, 1 - best.exponent);
    out.yield_stress = best.yield_fraction * viscosity * rate;
    out.rms = std::sqrt(least);
    return out;
}

CurveFit fit_flow_curve(const ViscositiesByRate& curve) {
    return fit_flow_curve(curve, curve.rates.front(), curve.rates.back());
}

std::string describe(const CurveFit& fit) {
    char text[120];
    std::snprintf(text, sizeof text, "K %.3g Pa s at 1/s, n %.3g, yield stress %.3g Pa", fit.consistency, fit.exponent,
        fit.yield_stress);
    return text;
}

} // namespace treacle::identify
