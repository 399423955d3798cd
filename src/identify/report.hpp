#pragma once
#include "identify/identification.hpp"

#include <filesystem>

namespace treacle::identify {

// Writes into `folder`, each file as a whole:
//   result.yaml   the identified values with their intervals, for programs
//   index.html    the same for people, with objective plots and misfits; opens from disk, needs nothing else
// Throws SimulationError.
void write_report(const std::filesystem::path& folder, const StudyFile& file, const Identification& identification);

// Lines for a terminal: "viscosity = 10.1 Pa.s, 90 % interval 9.7 to 10.5".
std::vector<std::string> answer_lines(const StudyFile& file, const Identification& identification);

// What the misfit says of the model: empty when the displacements left over are those of a contour's noise.
std::string verdict(const Identification& identification);

} // namespace treacle::identify
