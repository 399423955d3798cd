#pragma once
#include "identify/material/compared_curve.hpp"
#include "identify/material/material.hpp"
#include "identify/report/report_pictures.hpp"

#include <filesystem>
#include <functional>

namespace treacle::identify {

// Parts of a report that are made elsewhere.
struct ReportParts {
    std::vector<FlowCurveBand> curves;
    std::vector<Material> materials;
    std::vector<ReportPicture> hidden;     // pressure and speed; may be none
    std::optional<ComparedCurve> compared; // the run at a rheometer's curve
};

// Writes into `folder`, each file as a whole:
//   result.yaml   the identified values with their intervals, and the liquids that have them, for programs
//   index.html    the same for people, with plots, and pictures of observation and run at the best trial; opens from disk
// `folder_of` returns the folder of a run's files. Throws SimulationError.
void write_report(const std::filesystem::path& folder, const StudyFile& file, const Identification& identification,
    const std::function<std::filesystem::path(std::int64_t)>& folder_of, const ReportParts& parts);

// Lines for a terminal: "viscosity = 10.1 Pa.s, 90 % interval 9.7 to 10.5".
std::vector<std::string> answer_lines(const StudyFile& file, const Identification& identification);

inline constexpr const char* well_determined = "well determined";
// Identifiability of parameter k by the films: `well_determined`, or why not, in words.
std::string identifiability(const StudyFile& file, const Identification& identification, std::size_t k);

// Pairs of parameters that trade with each other, a sentence each. May be empty.
std::vector<std::string> trade_lines(const StudyFile& file, const Identification& identification);

// Verdict of the misfit on the model, a sentence an experiment: empty when what is left over is noise.
std::string verdict(const StudyFile& file, const Identification& identification);

// Notes on the experiments for a reader of the answer: on what a viscosity from falling bodies rests. May be empty.
std::vector<std::string> notes(const StudyFile& file);

} // namespace treacle::identify
