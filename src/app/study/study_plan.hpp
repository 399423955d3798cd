#pragma once
#include "base/text/error.hpp"
#include "study/study_runs.hpp"

namespace treacle::app {

// The size of a run, to which its cost is proportional.
struct RunSize {
    double particles = 0; // at the start, those that flow in and those of solids [count]
    double steps = 0;     // estimated
    double spacing = 0;   // [m]
    int dimensions = 3;
};
RunSize run_size(const study::Study& study, const study::Candidate& candidate);

// Cost of a run of known size.
struct MeasuredRun {
    RunSize size;
    double seconds = 0;        // of the clock, from the start of its process
    double start_seconds = 0;  // of that, before its first step
    double steps = 0;          // taken
    double bytes_by_step = 0;  // on disk: tables
    double bytes_by_frame = 0; // on disk: frames of the whole run [bytes]
    double bytes_fixed = 0;    // on disk: all else but checkpoints [bytes]
};

// Estimated cost of a study.
struct StudyPlan {
    std::size_t runs = 0;
    double core_seconds = 0; // ranks times seconds, summed over the runs [s]
    double seconds = 0;      // of the clock, on the study's lanes
    double bytes = 0;        // on disk, by what the study keeps
};
// Time in proportion to particles and steps, from the first step on; tables in proportion to steps, frames to particles.
StudyPlan plan_of(const study::RunOptions& options, const MeasuredRun& measured, const std::vector<RunSize>& sizes);

// `treacle study plan`: does one coarse run of the study, of the candidate in the middle, and prints how many runs,
// core-hours and bytes the sweep will take. Throws InputError, and SimulationError when that run fails.
ExitCode plan_study(
    const std::filesystem::path& file, const std::filesystem::path& out, const std::vector<std::string>& overrides);

} // namespace treacle::app
