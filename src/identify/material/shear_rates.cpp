#include "identify/material/shear_rates.hpp"

#include "base/text/csv.hpp"
#include "base/text/csv_reader.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace treacle::identify {

namespace {
constexpr double least_decade = -5, per_decade = 10;

double edge(double bin) { return std::pow(10.0, least_decade + bin / per_decade); } // [1/s] lower

std::filesystem::path frame_file(const std::filesystem::path& folder) { return folder / "shear_rates_by_frame.csv"; }
std::string quantile_name(double level) { return "below " + format_number(100 * level) + " %"; }

std::filesystem::path file_of(const std::filesystem::path& folder) { return folder / "shear_rates.csv"; }
} // namespace

void ShearRates::add(double rate, double weight) {
    if (!(rate > 0) || !(weight > 0)) return;
    const double bin = std::floor((std::log10(rate) - least_decade) * per_decade);
    weights_[std::size_t(std::clamp(bin, 0.0, double(bins - 1)))] += weight;
}

void ShearRates::add(const std::array<double, bins>& weights) {
    for (std::size_t i = 0; i < bins; ++i) weights_[i] += weights[i];
}

bool ShearRates::empty() const { return sum() == 0; }

double ShearRates::sum() const { return std::accumulate(weights_.begin(), weights_.end(), 0.0); }

double ShearRates::quantile(double level) const {
    const double wanted = level * sum();
    double below = 0;
    for (std::size_t i = 0; i < bins; ++i) {
        if (weights_[i] > 0 && below + weights_[i] >= wanted) return edge(double(i) + (wanted - below) / weights_[i]);
        below += weights_[i];
    }
    return 0;
}

double ShearRates::mean() const {
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < bins; ++i) {
        sum += weights_[i] * edge(double(i) + 0.5);
        weight += weights_[i];
    }
    return weight > 0 ? sum / weight : 0;
}

FrameShearRates frame_shear_rates(double time, const ShearRates& rates) {
    FrameShearRates out{time, {}, rates.mean(), rates.sum()};
    for (std::size_t i = 0; i < out.quantiles.size(); ++i)
        out.quantiles[i] = rates.quantile(FrameShearRates::quantile_levels[i]);
    return out;
}

const FrameShearRates& nearest_frame(const std::vector<FrameShearRates>& frames, double time) {
    return *std::ranges::min_element(
        frames, {}, [&](const FrameShearRates& frame) { return std::abs(frame.time - time); });
}

void write_frame_shear_rates(const std::filesystem::path& folder, const std::vector<FrameShearRates>& frames) {
    std::vector<std::string> names{"time [s]"};
    for (const double level : FrameShearRates::quantile_levels) names.push_back(quantile_name(level) + " [1/s]");
    names.push_back("mean [1/s]");
    names.push_back("dissipation");
    auto table = CsvTable::create(frame_file(folder), names);
    for (const auto& frame : frames) {
        std::vector<double> row{frame.time};
        row.insert(row.end(), frame.quantiles.begin(), frame.quantiles.end());
        row.push_back(frame.mean);
        row.push_back(frame.dissipation);
        table.append(row);
    }
    table.sync();
}

std::vector<FrameShearRates> read_frame_shear_rates(const std::filesystem::path& folder) {
    std::vector<FrameShearRates> out;
    if (!std::filesystem::exists(frame_file(folder))) return out;
    const auto table = read_csv(frame_file(folder));
    if (!table.find("dissipation")) return out; // by an earlier version
    for (std::size_t i = 0; i < table.rows(); ++i) {
        FrameShearRates frame{table.column("time")[i], {}, table.column("mean")[i], table.column("dissipation")[i]};
        for (std::size_t k = 0; k < frame.quantiles.size(); ++k)
            frame.quantiles[k] = table.column(quantile_name(FrameShearRates::quantile_levels[k]))[i];
        out.push_back(frame);
    }
    return out;
}

void write_shear_rates(const std::filesystem::path& folder, const ShearRates& rates) {
    auto table = CsvTable::create(file_of(folder), {"shear rate [1/s]", "dissipation"});
    for (std::size_t i = 0; i < ShearRates::bins; ++i)
        table.append(std::vector<double>{edge(double(i) + 0.5), rates.weights()[i]});
    table.sync();
}

ShearRates read_shear_rates(const std::filesystem::path& folder) {
    ShearRates out;
    if (!std::filesystem::exists(file_of(folder))) return out;
    const auto table = read_csv(file_of(folder));
    const auto& rate = table.column("shear rate");
    const auto& weight = table.column("dissipation");
    for (std::size_t i = 0; i < rate.size(); ++i) out.add(rate[i], weight[i]);
    return out;
}

} // namespace treacle::identify
