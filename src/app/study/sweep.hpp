#pragma once
#include "app/study/study_scenes.hpp"
#include "base/text/error.hpp"
#include "study/plots/table.hpp"

namespace treacle::app {

// Arguments of `treacle sweep`.
struct SweepRequest {
    std::filesystem::path study;        // file, or a folder that holds study.yaml
    std::filesystem::path out;          // default: out/<name of the study's folder or file>
    std::vector<std::string> overrides; // of the study: "runs.lanes=2"
    bool retry_failed = false;          // runs that failed before are done again
};

// `treacle sweep` in a process without MPI: does the runs of the study that are not done, and writes table.csv, table.h5
// and a plot of each figure against each parameter. Exit code 0 when all runs are done, 3 when some failed, 5 when stopped.
ExitCode sweep_study(const SweepRequest& request);

// The executable, absolute.
std::filesystem::path this_program();

// The runs of the study's sweep: every point in every scene. Throws InputError.
std::vector<study::Candidate> sweep_candidates(const identify::StudyFile& file);

// A study's file, or the study.yaml in a folder. Throws InputError when it is not there.
std::filesystem::path find_study(const std::filesystem::path& name);

// Requests runs; returns the numbers of those that differ, in their order: points that give the same run are one row.
std::vector<std::int64_t> ask_once(study::StudyRuns& runs, const std::vector<study::Candidate>& candidates);

// Tables and plots of these runs, and a line each for those that failed. Exit code 0 when all are done, 3 when some failed, 5
// when some have no outcome.
ExitCode write_results(const study::Study& study, const study::Journal& journal, const std::vector<std::int64_t>& runs,
    const std::filesystem::path& folder, Log& log);

// table.csv and table.h5.
void write_tables(const std::filesystem::path& folder, const study::Table& table);

// out/<name>, beside where the program is started.
std::filesystem::path study_folder(const std::filesystem::path& study, const std::filesystem::path& out);

} // namespace treacle::app
