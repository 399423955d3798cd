#pragma once
#include "base/text/file.hpp"
#include "study/model/run_record.hpp"

namespace treacle::study {

// The folder of a request: runs/0007.
std::string request_folder(std::int64_t number);

// Files of a request's folder, the input and output of `treacle forward`:
//   params.yaml   the study, the scene's name, the values and the key
//   params.in     the same values in Dakota's format of parameters files
//   run/          the run's own folder
//   result.json   the figures; its presence marks a run that is done, or stopped early at a bound of its objective
//   results.out   the figures in Dakota's format of results files: "0.31 front"
//   FAIL          or why there are none
// Each is written to a temporary name and renamed.
struct ForwardRequest {
    std::filesystem::path study; // absolute
    RunRequest run;
    std::vector<std::string> parameters; // their names
    std::vector<std::string> overrides;  // of the study
    double cut = no_cut;                 // the run may stop early once its objective is above
};
// The request of a study's run.
ForwardRequest request_of(const Study& study, const RunRequest& run);

// Writes params.in, then params.yaml; makes the folder. Throws SimulationError.
void write_request(
    const std::filesystem::path& folder, const ForwardRequest& request, Durability durability = Durability::synced);
// From params.yaml. Throws InputError.
ForwardRequest read_request(const std::filesystem::path& folder);

// Content of result.json.
struct ForwardResult {
    std::int64_t number = 0;          // of the run
    std::string key;                  // of the request
    std::vector<Figure> figures;      // NaN: null in the file
    double seconds = 0;               // of the clock
    double peak_bytes = 0;            // of memory, all ranks together
    std::optional<double> bound = {}; // that its objective is at least, where it stopped early: then without figures
};
// Writes results.out, and result.json last. Throws SimulationError.
void write_result(const std::filesystem::path& folder, const ForwardResult& result);
// Writes FAIL, and the word FAIL as results.out. Throws SimulationError.
void write_failure(const std::filesystem::path& folder, const std::string& reason);

// The result of the run of this key; nothing when there is none, or one of another key. Throws InputError for one that
// cannot be read.
std::optional<ForwardResult> read_result(const std::filesystem::path& folder, const std::string& key);
std::string read_failure(const std::filesystem::path& folder); // empty: none

// Takes from a result its run's outcome: status, reason, bound, figures.
void take_result(const ForwardResult& result, RunOutcome& outcome);

} // namespace treacle::study
