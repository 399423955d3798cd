#pragma once
#include "app/compare/observation_needs.hpp"
#include "app/render/frame_set.hpp"
#include "identify/compare/sheet_observation.hpp"
#include "identify/experiment/study_file.hpp"
#include "mpi/comm.hpp"

namespace treacle::app {

// The measured fields of an experiment with PIV, without vectors that touch the measured ball. Throws InputError.
identify::ObservedSheet observed_sheet(
    const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input);

// Needs of the fields of their run: frames at their times, and the path of a body that follows the measured one. Throws
// InputError for fields outside of the domain or longer than the run, and for a path that does not begin at its body.
ObservationNeeds sheet_needs(
    const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input);

// Compares a finished run with the fields, and writes residuals_NAME.csv, mismatches_NAME.csv and fields_NAME.csv into the
// folder. Collective; each rank compares some of the fields.
void compare_with_sheet(const Comm& comm, const identify::StudyFile& file, const identify::Experiment& experiment,
    const RunView& run, const std::filesystem::path& folder);

} // namespace treacle::app
