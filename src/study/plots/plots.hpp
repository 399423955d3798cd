#pragma once
#include "study/plots/table.hpp"

namespace treacle::study {

// A plot a figure and parameter of the runs that are done, as NAME_over_PARAMETER.svg; the parameter's axis is logarithmic
// where its scale is. Parameters that are words have none. Returns the files' names. Throws SimulationError.
std::vector<std::string> write_plots(const std::filesystem::path& folder, const Study& study, const Table& table);

} // namespace treacle::study
