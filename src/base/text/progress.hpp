#pragma once
#include "base/text/log.hpp"

#include <chrono>
#include <cstdint>
#include <string>

namespace treacle {

// Progress of a long command: a bar on a terminal; elsewhere, at most every 5 s and at the end, a line that scripts read:
// "progress TASK done=120 total=300 seconds=12.4 remaining=18.6".
class Progress {
public:
    Progress(Log& log, std::string task, std::string unit)
        : log_(log), task_(std::move(task)), unit_(std::move(unit)) {}

    // Numbers of units done and in all. A terminal is redrawn at most every 0.1 s.
    void report(std::int64_t done, std::int64_t total);
    // Ends the bar; elsewhere the last line, unless it has just been written.
    void finish();

private:
    using Clock = std::chrono::steady_clock;
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    void write_line();

    Log& log_;
    std::string task_, unit_;
    Clock::time_point start_ = Clock::now(), last_ = start_;
    std::int64_t done_ = 0, total_ = 0, written_ = -1;
};

} // namespace treacle
