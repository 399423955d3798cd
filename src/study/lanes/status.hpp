#pragma once
#include "study/lanes/journal.hpp"
#include "study/lanes/lanes.hpp"

#include <span>

namespace treacle::study {

// Progress of a study.
struct StudyStatus {
    std::size_t asked = 0, done = 0, stopped_early = 0, failed = 0;
    std::vector<LaneProgress> running;
    std::size_t speculative = 0; // runs under way without a request yet
    int lanes = 0;               // 0: none are at work
    double seconds = 0;          // of the clock, of this session; 0: not known
    double mean_seconds = 0;     // of a run that is done or stopped early; 0: none is
    double left = -1;            // [s]; negative: not known
};

// Outcomes of these runs by kind, and mean_seconds; all else is left as it starts.
StudyStatus count_runs(const Journal& journal, std::span<const std::int64_t> runs);

// From the mean time of finished runs, or of the share of its simulated time [s] that the fastest one has done.
double time_left(const StudyStatus& status, std::size_t fresh, double simulated_end);

// "12 done, 2 running, 1 failed of 40, 3 min 20 s left"
std::string describe(const StudyStatus& status);

// status.json, for other programs. Throws SimulationError.
void write_status(const std::filesystem::path& path, const StudyStatus& status);

} // namespace treacle::study
