#pragma once
#include "study/points.hpp"

#include <cstdint>
#include <optional>

namespace treacle::study {

// How a run ended. All but `done` are recorded with their reason, and rank worst in a search.
enum class RunStatus { done, failed, bad_input, out_of_memory, killed, timed_out, hung };
std::string word(RunStatus status);                   // "timed out"
std::optional<RunStatus> run_status(const std::string& word);

// A run that a study has asked for.
struct RunRequest {
    std::int64_t number = 0; // in the order in which it was first asked for, from 1
    std::string scene;       // name of the study's scene
    Point values;
    std::string key;         // hash of all that its result depends on
    std::vector<std::string> changes = {}; // of the scene after the parameters: "a.b.c=value"
};

struct Figure {
    std::string name; // "front [m]"
    double value = 0;
};

// What came of it.
struct RunOutcome {
    std::int64_t number = 0;
    RunStatus status = RunStatus::done;
    std::string reason; // of all but `done`, one line
    std::vector<Figure> figures;
    double seconds = 0;      // of the clock, from its start to its end
    double peak_bytes = 0;   // of memory, all ranks together; 0: not known
    double bytes = 0;        // on disk
    int lane = 0;
    std::string started;     // "2026-11-25T21:04:05.123Z"
    std::string host;
    std::string folder;      // of another study, when the run is one of its; else empty
};

} // namespace treacle::study
