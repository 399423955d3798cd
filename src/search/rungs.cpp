#include "search/rungs.hpp"

#include "base/text/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace treacle::search {

namespace {
constexpr std::array orders{0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0};
constexpr std::array sizes{0.003, 0.01, 0.03, 0.1, 0.3, 1.0}; // of the coarsest rung's error
constexpr std::array noise_factors{0.5, 0.71, 1.0, 1.41, 2.0, 2.83, 4.0};
constexpr double usual_order = 1.1,
                 order_deviation =
                     0.3;           // without the rungs: free surfaces are of first order, what else there is of second
constexpr double impurity = 0.1;    // of a power of the spacing, relative
constexpr double noise_order = 1.5; // in spacing
constexpr int passes = 3;           // of the slope that the impurity is a part of
constexpr double least_noise = 1e-5; // of values that are given without

std::vector<Rung> ordered(std::span<const Rung> given) {
    std::vector<Rung> rungs(given.begin(), given.end());
    std::ranges::sort(rungs, {}, &Rung::spacing);
    if (rungs.size() < 2)
        throw InputError({"", "a correction for resolution needs two rungs", "one has nothing to be compared with",
            "three show an order"});
    for (std::size_t k = 0; k < rungs.size(); ++k) {
        if (!(rungs[k].spacing > 0)) throw InputError({"", "a rung has a spacing that is not positive", "", ""});
        if (k > 0 && rungs[k].spacing == rungs[k - 1].spacing)
            throw InputError(
                {"", "two rungs have the same spacing", "their difference is noise, no effect of resolution", ""});
    }
    return rungs;
}

struct Model {
    double order = 0, size = 0, noise = 0;
    double evidence = 0;            // logarithm
    double value = 0, variance = 0; // of the value, less the finest rung's
};

// The value as the constant of a linear regression with an even prior on it and a normal one on the slope, whose covariance
// S = diag(s^2) + size^2 x x^T is inverted after Sherman and Morrison. What departs from the power is a part of the slope found.
void judge(std::span<const Rung> rungs, Model& model) {
    const double coarsest = rungs.back().spacing, square = model.size * model.size;
    double slope = model.size;
    for (int pass = 0; pass < passes; ++pass) {
        double ones = 0, one_x = 0, xx = 0, one_y = 0, xy = 0, yy = 0, determinant = 0;
        for (const Rung& rung : rungs) {
            const double h = rung.spacing / coarsest, x = std::pow(h, model.order),
                         y = rung.value - rungs.front().value;
            const double own =
                std::pow(model.noise * std::pow(h, noise_order), 2) / rung.runs + std::pow(impurity * slope * x, 2);
            ones += 1 / own;
            one_x += x / own;
            xx += x * x / own;
            one_y += y / own;
            xy += x * y / own;
            yy += y * y / own;
            determinant += std::log(own);
        }
        const double k = square / (1 + square * xx), information = ones - k * one_x * one_x;
        model.value = (one_y - k * one_x * xy) / information;
        model.variance = 1 / information;
        model.evidence = -0.5 * (determinant + std::log(1 + square * xx) + std::log(information) + yy - k * xy * xy -
                                    model.value * model.value * information);
        slope = std::min(model.size, std::abs(k * (xy - model.value * one_x)));
    }
}

// Logarithm of the probability that the noise is `factor` times what was measured with n degrees of freedom: chi-square, and even in
// the logarithm of the noise before.
double noise_evidence(double factor, int n) { return -n * std::log(factor) - 0.5 * n / (factor * factor); }

std::vector<Model> models_of(std::span<const Rung> rungs, const RungNoise& noise) {
    std::vector<Model> out;
    for (const double order : orders) {
        for (const double size : sizes) {
            for (const double factor : noise_factors) {
                Model model{order, size, std::max(least_noise, factor * noise.deviation), 0, 0, 0};
                judge(rungs, model);
                model.evidence += noise_evidence(factor, std::max(1, noise.freedom)) -
                                  0.5 * std::pow((order - usual_order) / order_deviation, 2);
                out.push_back(model);
            }
        }
    }
    const double most = std::ranges::max(out, {}, &Model::evidence).evidence;
    double sum = 0;
    for (auto& model : out) sum += model.evidence = std::exp(model.evidence - most);
    for (auto& model : out) model.evidence /= sum;
    return out;
}

std::string text_of(const Extrapolation& out, double deviation, std::size_t rungs) {
    char text[200];
    std::snprintf(text, sizeof text,
        "an order of %.1f +- %.1f in spacing over %zu rungs, a correction of %+.2g with a standard deviation of %.2g",
        out.order, deviation, rungs, out.correction, out.deviation);
    return text;
}
} // namespace

Extrapolation extrapolate(std::span<const Rung> rungs, const RungNoise& noise) {
    const auto sorted = ordered(rungs);
    const auto models = models_of(sorted, noise);
    const double finest = sorted.front().spacing / sorted.back().spacing;
    Extrapolation out;
    double square = 0, orders_square = 0, noises = 0;
    for (const auto& model : models) {
        out.correction += model.evidence * model.value;
        out.order += model.evidence * model.order;
        square += model.evidence * (model.variance + model.value * model.value);
        orders_square += model.evidence * model.order * model.order;
        noises += model.evidence * model.noise * model.noise;
    }
    out.value = sorted.front().value + out.correction;
    out.deviation = std::sqrt(std::max(0.0, square - out.correction * out.correction));
    out.noise = noise.deviation > 0
                    ? std::min(out.deviation, std::sqrt(noises / sorted.front().runs) * std::pow(finest, noise_order))
                    : 0;
    out.text = text_of(out, std::sqrt(std::max(0.0, orders_square - out.order * out.order)), sorted.size());
    return out;
}

} // namespace treacle::search
