#include "identify/material/flow_curve_band.hpp"

#include "base/text/csv_reader.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "identify/experiment/digits.hpp"
#include "study/plots/chart.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace treacle::identify {

namespace {
constexpr double usual_low = 1, usual_high = 30; // [1/s] over which rheometers' curves are compared

// The column whose name begins so; its unit, where it is stated in brackets, must be the given one.
const std::vector<double>& column_of(
    const CsvColumns& table, const std::vector<std::string>& begins, const std::vector<std::string>& units) {
    for (std::size_t i = 0; i < table.names.size(); ++i) {
        const auto& name = table.names[i];
        if (std::ranges::none_of(begins, [&](const std::string& begin) { return name.starts_with(begin); })) continue;
        const auto bracket = name.find('[');
        const auto unit = bracket == std::string::npos
                              ? std::string()
                              : name.substr(bracket + 1, name.find(']', bracket) - bracket - 1);
        if (!unit.empty() && std::ranges::find(units, unit) == units.end()) {
            throw InputError({table.path.string(), "column " + name + " is not in " + units.front(),
                "curves are compared in SI", "convert it"});
        }
        return table.values[i];
    }
    throw InputError({table.path.string(), "has no column whose name begins with " + begins.front(),
        "it has " + join(table.names, ", "), "name the columns \"shear rate [1/s]\" and \"viscosity [Pa.s]\""});
}

std::string list(const std::vector<double>& values) {
    std::vector<std::string> words;
    words.reserve(values.size());
    for (const double value : values) words.push_back(digits(value, 3));
    return "[" + join(words, ", ") + "]";
}
} // namespace

std::optional<double> ViscositiesByRate::at(double rate) const {
    if (rates.empty() || !(rate >= rates.front()) || !(rate <= rates.back())) return {};
    const auto after = std::min<std::ptrdiff_t>(
        std::ranges::upper_bound(rates, rate) - rates.begin(), std::ptrdiff_t(rates.size()) - 1);
    if (after == 0) return viscosities.front();
    const auto b = std::size_t(after), a = b - 1;
    const double fraction = std::log(rate / rates[a]) / std::log(rates[b] / rates[a]);
    return std::exp((1 - fraction) * std::log(viscosities[a]) + fraction * std::log(viscosities[b]));
}

ViscositiesByRate read_flow_curve(const std::filesystem::path& path) {
    const auto table = read_csv(path);
    const auto& rates = column_of(table, {"shear rate", "shear_rate"}, {"1/s", "s-1", "s^-1"});
    const auto& viscosities = column_of(table, {"viscosity"}, {"Pa.s", "Pa s"});
    std::vector<std::size_t> order(rates.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t i) { return rates[i]; });
    ViscositiesByRate out;
    for (const auto i : order) {
        if (!(rates[i] > 0) || !(viscosities[i] > 0) || (!out.rates.empty() && rates[i] == out.rates.back())) continue;
        out.rates.push_back(rates[i]);
        out.viscosities.push_back(viscosities[i]);
    }
    if (out.rates.size() < 2)
        throw InputError({path.string(), "has fewer than two points with positive numbers",
            "there is no curve to compare with", ""});
    return out;
}

std::optional<double> curve_error(const FlowCurveBand& band, double from, double to) {
    if (!band.measured) return {};
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < band.measured->rates.size(); ++i) {
        const double rate = band.measured->rates[i];
        const auto value = band.value.at(rate);
        if (rate < from || rate > to || !value) continue;
        sum += std::pow(std::log(*value / band.measured->viscosities[i]), 2);
        ++count;
    }
    if (count == 0) return {};
    return std::sqrt(sum / count);
}

std::vector<std::string> describe(const FlowCurveBand& band) {
    std::vector<std::string> out;
    if (!band.flow.empty()) {
        const double mean = band.flow.mean(), low = band.flow.quantile(0.05), high = band.flow.quantile(0.95);
        out.push_back(band.liquid + ": sheared at " + digits(low, 3) + " to " + digits(high, 3) +
                      " 1/s (90 % of what it dissipates), at " + digits(mean, 3) + " 1/s on average");
        const double rate = band.answer_rate > 0 ? band.answer_rate : mean;
        const auto value = band.value.at(rate);
        const auto measured = band.measured ? band.measured->at(rate) : std::nullopt;
        if (value && measured) {
            out.push_back(band.liquid + ": at " + digits(rate, 3) + " 1/s " + digits(*value, 3) + " Pa s, measured " +
                          digits(*measured, 3) + " Pa s (" + digits(100 * (*value / *measured - 1), 3) + " %)");
        }
        if (const auto error = curve_error(band, low, high))
            out.push_back(band.liquid + ": " + digits(100 * *error, 3) +
                          " % from the measured curve over the flow's shear rates (root mean square of logarithms)");
    }
    if (const auto error = curve_error(band, usual_low, usual_high))
        out.push_back(band.liquid + ": " + digits(100 * *error, 3) + " % from it over 1 to 30 1/s");
    return out;
}

std::string yaml(const FlowCurveBand& band) {
    std::string out = "  - liquid: " + band.liquid + "\n    shear_rates: " + list(band.value.rates) +
                      "\n    viscosities: " + list(band.value.viscosities) +
                      "\n    low_90: " + list(band.low.viscosities) + "\n    high_90: " + list(band.high.viscosities) +
                      "\n";
    if (!band.flow.empty()) {
        out += "    flow: {mean: " + format_number(band.flow.mean()) +
               " 1/s, from: " + format_number(band.flow.quantile(0.05)) +
               " 1/s, to: " + format_number(band.flow.quantile(0.95)) +
               " 1/s, of_answer: " + (band.answer_rate > 0 ? format_number(band.answer_rate) + " 1/s" : "null") + "}\n";
        if (const auto error = curve_error(band, band.flow.quantile(0.05), band.flow.quantile(0.95)))
            out += "    error_over_flow: " + format_number(*error) + "\n";
    }
    if (const auto error = curve_error(band, usual_low, usual_high))
        out += "    error_1_to_30: " + format_number(*error) + "\n";
    return out;
}

std::string chart(const FlowCurveBand& band) {
    study::Chart out;
    out.title = "Flow curve: " + band.liquid;
    out.x = {"shear rate [1/s]", study::AxisScale::log};
    out.y = {"viscosity [Pa.s]", study::AxisScale::log};
    study::ChartSeries outline{"90 %", band.low.rates, band.low.viscosities,
        true}; // there along the lower end of the band, and back along the upper one
    outline.x.insert(outline.x.end(), band.high.rates.rbegin(), band.high.rates.rend());
    outline.y.insert(outline.y.end(), band.high.viscosities.rbegin(), band.high.viscosities.rend());
    out.series = {{"identified", band.value.rates, band.value.viscosities, true}, outline};
    if (band.measured) out.series.push_back({"measured", band.measured->rates, band.measured->viscosities, false});
    return svg(out);
}

} // namespace treacle::identify
