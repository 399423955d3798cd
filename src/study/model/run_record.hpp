#pragma once
#include "study/model/points.hpp"

#include <cstdint>
#include <limits>
#include <optional>

namespace treacle::study {

// Status with which a run ended. One that stopped early is no failure: its objective had passed the cut that it was
// requested with. The others but `done` rank worst in a search. All but `done` are recorded with their reason.
enum class RunStatus { done, stopped_early, failed, bad_input, out_of_memory, killed, timed_out, hung };
std::string word(RunStatus status); // "timed out"
std::optional<RunStatus> run_status(const std::string& text);
bool is_failure(RunStatus status);

// A cut that no objective is above.
constexpr double no_cut = std::numeric_limits<double>::infinity();

// A run that a study has requested.
struct RunRequest {
    std::int64_t number = 0; // in the order of the first requests, from 1
    std::string scene;       // name of the study's scene
    Point values;
    std::string key;                       // hash of all that its result depends on
    std::vector<std::string> changes = {}; // of the scene after the parameters: "a.b.c=value"
};

// Number read from a finished run.
struct Figure {
    std::string name; // "front [m]"
    double value = 0; // in the unit of the name; NaN: none
};

// Outcome of a run.
struct RunOutcome {
    std::int64_t number = 0;
    RunStatus status = RunStatus::done;
    std::string reason; // of all but `done`, one line
    std::vector<Figure> figures;
    double seconds = 0;    // of the clock, from its start to its end
    double peak_bytes = 0; // of memory, all ranks together; 0: not known
    double bytes = 0;      // on disk
    int lane = 0;
    std::string started; // "2026-11-25T21:04:05.123Z"
    std::string host;
    std::string folder; // of another study, when the run is one of its; else empty
    double bound = 0;   // of `stopped_early`: what the objective is at least

    // True when it is sufficient for a run that may stop above `cut`.
    bool answers(double cut) const { return status != RunStatus::stopped_early || bound > cut; }
};

} // namespace treacle::study
