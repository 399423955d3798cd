#pragma once
#include "identify/material/shear_rates.hpp"

#include <optional>
#include <string>
#include <vector>

namespace treacle::identify {

// Viscosities by shear rate, in ascending order of the rates [1/s], [Pa s].
struct ViscositiesByRate {
    std::vector<double> rates, viscosities; // [n] [1/s], [n] [Pa s]

    // Between two points the logarithms are linear; nothing outside.
    std::optional<double> at(double rate) const;
};

// Reads a rheometer's table: a column whose name begins with "shear rate" or "shear_rate", in 1/s, and one that begins with "viscosity", in Pa s.
// Throws InputError.
ViscositiesByRate read_flow_curve(const std::filesystem::path& path);

// The viscosity of an identified liquid by shear rate, with a 90 % band.
struct FlowCurveBand {
    std::string liquid;
    ViscositiesByRate value, low, high; // at the same rates
    ShearRates flow;                    // of the runs at the best trial
    double answer_rate = 0; // [1/s] mean by dissipation and by the frames' shares in the information; 0: unknown
    std::optional<ViscositiesByRate> measured; // by a rheometer
};

// Root mean square of the logarithms of value over measured, at the measured rates within [from, to]; nothing where there are none.
std::optional<double> curve_error(const FlowCurveBand& band, double from, double to);

// Sentences: the shear rates that the flow had, and how far the curve is from the measured one over these and over 1 to 30 1/s.
std::vector<std::string> describe(const FlowCurveBand& band);
// For result.yaml, an item of a list.
std::string yaml(const FlowCurveBand& band);
// A chart as SVG.
std::string chart(const FlowCurveBand& band);

} // namespace treacle::identify
