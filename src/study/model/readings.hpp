#pragma once
#include "study/model/run_record.hpp"

#include <filesystem>

namespace treacle::study {

// The figures that a study reads from the tables of a finished run, in the order of `read`; without any, the last value of
// each column of measurements.csv but the step and the time. Throws InputError, with the place of the reading, for a column
// that is not there.
std::vector<Figure> read_figures(const Study& study, const std::filesystem::path& run_folder);

// True when figures are those that the study reads, by their names; always where it names none.
bool are_read(const Study& study, const std::vector<Figure>& figures);

// A statistic of a column over time [s]; the mean is the integral by the trapezoidal rule over the span, and of one row that
// row. Not a number where there are no rows, or none that hold a number.
double statistic(const std::vector<double>& times, const std::vector<double>& values, Statistic at, double time = 0);

} // namespace treacle::study
