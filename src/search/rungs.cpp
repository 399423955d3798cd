#include "search/rungs.hpp"

#include "base/error.hpp"
#include "search/matrix.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace treacle::search {

namespace {
constexpr double least_order = 0.5, most_order = 2.1; // Eca & Hoekstra 2014: what second order in theory may show
constexpr double safety = 1.25;                       // Roache 1994

std::vector<Rung> ordered(std::span<const Rung> given) {
    std::vector<Rung> rungs(given.begin(), given.end());
    std::sort(rungs.begin(), rungs.end(), [](const Rung& a, const Rung& b) { return a.spacing < b.spacing; });
    if (rungs.size() < 2)
        throw InputError({"", "a correction for resolution needs two rungs", "one has nothing to be compared with",
                          "three show an order"});
    for (std::size_t k = 0; k < rungs.size(); ++k) {
        if (!(rungs[k].spacing > 0)) throw InputError({"", "a rung has a spacing that is not positive", "", ""});
        if (k > 0 && rungs[k].spacing == rungs[k - 1].spacing)
            throw InputError({"", "two rungs have the same spacing", "their difference is noise, no effect of resolution", ""});
    }
    return rungs;
}

struct Fit {
    double value = 0, slope = 0; // of value + slope (h / finest)^p
    double squares = 0;          // of the rests
    double order = 0;
};

// Two unknowns at a given order (R1).
Fit fit_at(std::span<const Rung> rungs, double order) {
    const std::size_t n = rungs.size();
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
    std::vector<double> x;
    for (const Rung& rung : rungs) x.push_back(std::pow(rung.spacing / rungs[0].spacing, order));
    for (std::size_t k = 0; k < n; ++k) {
        mean_x += x[k] / double(n);
        mean_y += rungs[k].value / double(n);
    }
    for (std::size_t k = 0; k < n; ++k) {
        xx += (x[k] - mean_x) * (x[k] - mean_x);
        xy += (x[k] - mean_x) * (rungs[k].value - mean_y);
    }
    Fit out;
    out.order = order;
    out.slope = xy / xx;
    out.value = mean_y - out.slope * mean_x;
    for (std::size_t k = 0; k < n; ++k) out.squares += std::pow(rungs[k].value - out.value - out.slope * x[k], 2);
    return out;
}

// The order of the least rests, from a grid and then golden sections; none at the ends of the range.
std::optional<Fit> fit(std::span<const Rung> rungs) {
    constexpr double spacing = 0.05, low = 0.1, high = 6;
    Fit best = fit_at(rungs, low);
    for (double order = low; order <= high; order += spacing)
        if (const Fit other = fit_at(rungs, order); other.squares < best.squares) best = other;
    double a = best.order - spacing, b = best.order + spacing;
    constexpr double section = 0.6180339887498949;
    for (int k = 0; k < 60; ++k) {
        const double c = b - section * (b - a), d = a + section * (b - a);
        (fit_at(rungs, c).squares < fit_at(rungs, d).squares ? b : a) = fit_at(rungs, c).squares < fit_at(rungs, d).squares ? d : c;
    }
    best = fit_at(rungs, 0.5 * (a + b));
    if (best.order < least_order || best.order > most_order) return std::nullopt;
    return best;
}

double largest_difference(std::span<const Rung> rungs) {
    const auto [least, most] = std::minmax_element(rungs.begin(), rungs.end(),
                                                   [](const Rung& a, const Rung& b) { return a.value < b.value; });
    return most->value - least->value;
}

// Standard deviation of the value that the noise of each rung makes, by way of the order too.
double noise_of_value(std::vector<Rung> rungs, const Fit& found, double noise) {
    double sum = 0;
    for (Rung& rung : rungs) {
        const double before = rung.value;
        rung.value += noise;
        sum += std::pow(fit(rungs).value_or(fit_at(rungs, found.order)).value - found.value, 2);
        rung.value = before;
    }
    return std::sqrt(sum);
}

// The value at spacing zero of value + a h + b h^2 (R3).
double value_of_two_orders(std::span<const Rung> rungs) {
    Matrix a(rungs.size(), 3);
    std::vector<double> values;
    for (std::size_t k = 0; k < rungs.size(); ++k) {
        const double h = rungs[k].spacing / rungs[0].spacing;
        a(k, 0) = 1;
        a(k, 1) = h;
        a(k, 2) = h * h;
        values.push_back(rungs[k].value);
    }
    return least_squares(std::move(a), std::move(values))[0];
}

// Deviation of the fit by its degrees of freedom; three rungs have none left.
double deviation_of(const Fit& fit, std::size_t rungs) {
    return rungs > 3 ? std::sqrt(fit.squares / double(rungs - 3)) : std::sqrt(fit.squares);
}

Extrapolation from_difference(std::span<const Rung> rungs, double noise, const std::string& why) {
    Extrapolation out;
    out.value = rungs[0].value;
    out.deviation = std::max(largest_difference(rungs), noise);
    out.text = why + ": no correction, and the largest difference between rungs as its deviation";
    return out;
}
} // namespace

Extrapolation extrapolate(std::span<const Rung> given, double noise) {
    const auto rungs = ordered(given);
    if (rungs.size() < 3) return from_difference(rungs, noise, "two rungs show no order");
    if (largest_difference(rungs) <= 2 * noise)
        return from_difference(rungs, noise, "the rungs differ by no more than their noise");
    const auto found = fit(rungs);
    if (!found) {
        auto out = from_difference(rungs, noise, "no order between 0.5 and 2.1 is observed");
        out.deviation = std::max(out.deviation, std::abs(value_of_two_orders(rungs) - out.value));
        return out;
    }
    Extrapolation out;
    out.value = found->value;
    out.order = found->order;
    out.correction = out.value - rungs[0].value;
    const double miss = std::abs(found->value + found->slope - rungs[0].value);
    const double bound = safety * std::abs(out.correction) + deviation_of(*found, rungs.size()) + miss; // (R2)
    out.deviation = std::max(std::hypot(0.5 * bound, noise_of_value(rungs, *found, noise)), noise);
    out.text = "the order observed over " + std::to_string(rungs.size()) + " rungs";
    return out;
}

} // namespace treacle::search
