#include "identify/shear_rates.hpp"

#include "base/csv.hpp"
#include "base/csv_reader.hpp"
#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace treacle::identify {

namespace {
constexpr double least_decade = -5, per_decade = 10;

double edge(double bin) { return std::pow(10.0, least_decade + bin / per_decade); } // [1/s] lower

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

bool ShearRates::empty() const { return std::accumulate(weights_.begin(), weights_.end(), 0.0) == 0; }

double ShearRates::quantile(double share) const {
    const double wanted = share * std::accumulate(weights_.begin(), weights_.end(), 0.0);
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

void write_shear_rates(const std::filesystem::path& folder, const ShearRates& rates) {
    auto table = CsvTable::create(file_of(folder), {"shear rate [1/s]", "dissipation"});
    for (std::size_t i = 0; i < ShearRates::bins; ++i) table.append(std::vector<double>{edge(double(i) + 0.5), rates.weights()[i]});
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
