#include "app/flow_curve_bands.hpp"

#include "app/identified_liquids.hpp"
#include "flow/flow_curve.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {
constexpr double least_rate = 0.01, most_rate = 1000; // [1/s]
constexpr int points = 31;

// The curve of a liquid at given values of the searched parameters; nothing where no scene has the liquid.
std::optional<flow::FlowCurve> curve_at(const identify::StudyFile& file, const std::string& liquid, const std::vector<double>& searched) {
    const auto found = liquid_at(file, liquid, searched);
    if (!found) return {};
    return flow::make_flow_curve(*found);
}

// Values a little away along one coordinate, inside its range, and how far.
std::pair<std::vector<double>, double> moved(const identify::StudyFile& file, std::vector<double> values, std::size_t k) {
    const auto& parameter = file.study.parameters[k];
    const bool log = parameter.scale == study::Scale::log;
    const auto coordinate = [&](double value) { return log ? std::log(value) : value; };
    const double x = coordinate(values[k]), lower = coordinate(parameter.lower), upper = coordinate(parameter.upper);
    const double step = 0.01 * (upper - lower) * (x + 0.01 * (upper - lower) <= upper ? 1 : -1);
    values[k] = log ? std::exp(x + step) : x + step;
    return {std::move(values), step};
}

identify::FlowCurveBand band_of(const identify::StudyFile& file, const identify::Identification& found, const std::string& liquid, const flow::FlowCurve& curve) {
    constexpr double ninety = 1.6449;
    identify::FlowCurveBand out;
    out.liquid = liquid;
    std::vector<flow::FlowCurve> others;
    std::vector<double> steps;
    for (std::size_t k = 0; k < file.searched; ++k) {
        const auto [values, step] = moved(file, found.values, k);
        others.push_back(*curve_at(file, liquid, values));
        steps.push_back(step);
    }
    for (int i = 0; i < points; ++i) {
        const double rate = least_rate * std::pow(most_rate / least_rate, double(i) / (points - 1)), value = curve(rate);
        Eigen::VectorXd slope{Eigen::Index(others.size())};
        for (std::size_t k = 0; k < others.size(); ++k) slope[Eigen::Index(k)] = std::log(others[k](rate) / value) / steps[k];
        const double half = ninety * std::sqrt(std::max(0.0, slope.dot(found.covariance * slope)));
        for (auto* one : {&out.value, &out.low, &out.high}) one->rates.push_back(rate);
        out.value.viscosities.push_back(value);
        out.low.viscosities.push_back(value * std::exp(-half));
        out.high.viscosities.push_back(value * std::exp(half));
    }
    return out;
}

} // namespace

std::vector<identify::FlowCurveBand> flow_curve_bands(const identify::StudyFile& file, const identify::Identification& identification,
                                                      const std::function<std::filesystem::path(std::int64_t)>& folder_of, const std::optional<identify::ViscositiesByRate>& measured) {
    std::vector<identify::FlowCurveBand> out;
    if (!identification.estimate) return out;
    identify::ShearRates flow;
    if (const auto* best = identify::best_trial(identification)) {
        for (const auto run : best->runs) flow.add(identify::read_shear_rates(folder_of(run)).weights());
    }
    for (const auto& liquid : searched_liquids(file)) {
        const auto curve = curve_at(file, liquid, identification.values);
        if (!curve || !((*curve)(1) > 0)) continue;
        out.push_back(band_of(file, identification, liquid, *curve));
        out.back().flow = flow;
        out.back().measured = measured;
    }
    return out;
}

} // namespace treacle::app
