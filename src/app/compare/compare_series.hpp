#pragma once
#include "app/compare/observation_needs.hpp"
#include "app/input/input.hpp"
#include "identify/compare/series_comparison.hpp"
#include "identify/experiment/study_file.hpp"

namespace treacle::app {

// The measured values of an experiment with a series, in the unit of the run's column. Throws InputError, also for a measurement
// that the scene does not have.
std::vector<identify::ObservedValue> observed_series(
    const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input);

// A series needs no frames. Throws InputError for values beyond the run's end.
ObservationNeeds series_needs(
    const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input);

// Compares the table of a finished run, in `folder`/run, with the values, and writes residuals_NAME.csv and mismatches_NAME.csv.
// On one rank. Throws InputError for a column that the table does not have.
void compare_with_series(const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input,
    const std::filesystem::path& folder);

} // namespace treacle::app
