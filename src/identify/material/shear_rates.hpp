#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

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
    // The rate below which this fraction of the dissipation happened [1/s]; 0 when empty.
    double quantile(double level) const;
    // Mean weighted by dissipation [1/s]; 0 when empty.
    double mean() const;
    double sum() const; // of the weights
    const std::array<double, bins>& weights() const { return weights_; }

private:
    std::array<double, bins> weights_{};
};

// Shear rates of a frame of a run: those below which these fractions of the dissipation lie, and their mean [1/s].
struct FrameShearRates {
    static constexpr std::array<double, 5> quantile_levels{0.05, 0.25, 0.5, 0.75, 0.95}; // of the dissipation, 0 to 1
    double time = 0;                                                                     // [s]
    std::array<double, 5> quantiles{}; // [1/s] one for each of `quantile_levels`
    double mean = 0;                   // [1/s] weighted by dissipation
    double dissipation = 0;            // of the frame, against that of others of the run
};
FrameShearRates frame_shear_rates(double time, const ShearRates& rates);
// The frame nearest to a time [s], of one or more.
const FrameShearRates& nearest_frame(const std::vector<FrameShearRates>& frames, double time);

// shear_rates_by_frame.csv in a run's folder. Throws SimulationError.
void write_frame_shear_rates(const std::filesystem::path& folder, const std::vector<FrameShearRates>& frames);
// Empty where there is no such file. Throws InputError for a damaged one.
std::vector<FrameShearRates> read_frame_shear_rates(const std::filesystem::path& folder);

// shear_rates.csv in a run's folder, by the middles of the bins. Throws SimulationError.
void write_shear_rates(const std::filesystem::path& folder, const ShearRates& rates);
// Empty where there is no such file. Throws InputError for a damaged one.
ShearRates read_shear_rates(const std::filesystem::path& folder);

} // namespace treacle::identify
