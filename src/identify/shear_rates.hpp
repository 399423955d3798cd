#pragma once
#include <array>
#include <cstddef>
#include <filesystem>

namespace treacle::identify {

// Shear rates that liquid had: how much of what it dissipated fell to each tenth of a decade from 1e-5 to 1e5 1/s. What lies outside
// counts for the ends.
class ShearRates {
public:
    static constexpr std::size_t bins = 100;

    // rate [1/s]; weights count against each other, and may be dissipation per volume, eta rate^2 [W/m3].
    void add(double rate, double weight);
    void add(const std::array<double, bins>& weights);
    bool empty() const;
    // The rate below which this share of the dissipation happened [1/s]; 0 when empty.
    double quantile(double share) const;
    // Mean weighted by dissipation [1/s]; 0 when empty.
    double mean() const;
    const std::array<double, bins>& weights() const { return weights_; }

private:
    std::array<double, bins> weights_{};
};

// shear_rates.csv in a run's folder, by the middles of the bins. Throws SimulationError.
void write_shear_rates(const std::filesystem::path& folder, const ShearRates& rates);
// Empty where there is no such file. Throws InputError for a damaged one.
ShearRates read_shear_rates(const std::filesystem::path& folder);

} // namespace treacle::identify
