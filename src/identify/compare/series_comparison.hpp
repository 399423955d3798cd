#pragma once
#include "base/text/csv_reader.hpp"
#include "identify/compare/residual_file.hpp"
#include "identify/experiment/experiment.hpp"

namespace treacle::identify {

// A measured value.
struct ObservedValue {
    int number = 0;       // row of the file, from 0
    double time = 0;      // [s] of the scene
    double value = 0;     // in SI
    double deviation = 0; // likewise
};

// The rows between `from` and `to`, every so many of them. `unit`: that of the run's values, "m". Throws InputError for columns
// that are missing, without a unit or of another dimension, and deviations that are not positive.
std::vector<ObservedValue> observed_values(
    const Experiment& experiment, const std::filesystem::path& file, const std::string& unit);

// Simulated less measured values over their deviations; the run's are linear between its rows. Rows beyond the run's have no value.
RunResiduals compare_series(
    const std::vector<ObservedValue>& observed, const std::vector<double>& times, const std::vector<double>& values);

// "m" of "front [m]"; empty without one.
std::string unit_in(const std::string& column);
// A column of a table in SI: one whose name is `name`, with a unit of that dimension in brackets. `pixel` [m] of px; 0: none.
// Throws InputError.
std::vector<double> column_in_si(
    const CsvColumns& table, const std::string& name, const std::string& si, double pixel = 0);

} // namespace treacle::identify
