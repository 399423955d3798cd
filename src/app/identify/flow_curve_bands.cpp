#include "app/identify/flow_curve_bands.hpp"

#include "app/identify/identified_liquids.hpp"
#include "flow/viscosity_model.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {
constexpr double least_rate = 0.01, most_rate = 1000; // [1/s]
constexpr int points = 31;

// The curve of a liquid at given values of the searched parameters; nothing where no scene has the liquid.
std::optional<flow::ViscosityModel> curve_at(
    const identify::StudyFile& file, const std::string& liquid, const std::vector<double>& searched) {
    const auto found = liquid_at(file, liquid, searched);
    if (!found) return {};
    return flow::make_viscosity_model(*found);
}

identify::FlowCurveBand band_of(const identify::StudyFile& file, const identify::Identification& found,
    const std::string& liquid, const flow::ViscosityModel& curve) {
    constexpr double ninety = 1.6449;
    identify::FlowCurveBand out;
    out.liquid = liquid;
    for (int i = 0; i < points; ++i)
        out.value.rates.push_back(least_rate * std::pow(most_rate / least_rate, double(i) / (points - 1)));
    out.low.rates = out.high.rates = out.value.rates;
    const auto slopes = flow_curve_slopes(file, found.values, liquid, out.value.rates);
    for (int i = 0; i < points; ++i) {
        const double value = curve(out.value.rates[std::size_t(i)]);
        const Eigen::VectorXd slope = slopes.row(i).transpose();
        const double half = ninety * std::sqrt(std::max(0.0, slope.dot(found.covariance * slope)));
        out.value.viscosities.push_back(value);
        out.low.viscosities.push_back(value * std::exp(-half));
        out.high.viscosities.push_back(value * std::exp(half));
    }
    return out;
}

// The shear rate that a single parameter's answer holds at [1/s]; 0 where it is unknown.
double rate_of_answer(const identify::StudyFile& file, const identify::Estimate& estimate,
    const std::vector<std::int64_t>& runs, const std::function<std::filesystem::path(std::int64_t)>& folder_of) {
    std::vector<std::vector<identify::FrameShearRates>> frames;
    for (const auto run : runs) frames.push_back(identify::read_frame_shear_rates(folder_of(run)));
    double sum = 0, weights = 0;
    for (std::size_t k = 0; k < estimate.information_fraction.size(); ++k) {
        const auto& experiment = file.experiments[estimate.misfit_of[k]];
        const auto scene = std::size_t(&file.scene_of(experiment) - file.study.scenes.data());
        if (scene >= frames.size() || frames[scene].empty()) return 0;
        const auto& frame = identify::nearest_frame(frames[scene], estimate.times[k]);
        const double weight = estimate.information_fraction[k] * frame.dissipation;
        sum += weight * frame.mean;
        weights += weight;
    }
    return weights > 0 ? sum / weights : 0;
}

} // namespace

Eigen::MatrixXd flow_curve_slopes(const identify::StudyFile& file, const std::vector<double>& answer,
    const std::string& liquid, const std::vector<double>& rates) {
    constexpr double fraction = 0.01; // of the range: linear, far above round-off
    const auto here = *curve_at(file, liquid, answer);
    Eigen::MatrixXd out(Eigen::Index(rates.size()), Eigen::Index(file.searched));
    for (std::size_t k = 0; k < file.searched; ++k) {
        auto values = answer;
        const double step = identify::move_along(file.study.parameters[k], fraction, values[k]);
        const auto there = *curve_at(file, liquid, values);
        for (std::size_t i = 0; i < rates.size(); ++i)
            out(Eigen::Index(i), Eigen::Index(k)) = std::log(there(rates[i]) / here(rates[i])) / step;
    }
    return out;
}

std::vector<identify::FlowCurveBand> flow_curve_bands(const identify::StudyFile& file,
    const identify::Identification& identification, const std::function<std::filesystem::path(std::int64_t)>& folder_of,
    const std::optional<MeasuredCurve>& measured) {
    std::vector<identify::FlowCurveBand> out;
    if (!identification.estimate) return out;
    identify::ShearRates flow;
    double answer_rate = 0;
    if (const auto* best = identify::best_trial(identification)) {
        answer_rate = rate_of_answer(file, *identification.estimate, best->runs, folder_of);
        for (const auto run : best->runs) flow.add(identify::read_shear_rates(folder_of(run)).weights());
    }
    for (const auto& liquid : searched_liquids(file)) {
        const auto curve = curve_at(file, liquid, identification.values);
        if (!curve || !((*curve)(1) > 0)) continue;
        out.push_back(band_of(file, identification, liquid, *curve));
        out.back().flow = flow;
        out.back().answer_rate = answer_rate;
        if (measured && measured->is_of(liquid)) out.back().measured = measured->curve;
    }
    return out;
}

} // namespace treacle::app
