#pragma once
#include "study/lanes/child_process.hpp"
#include "study/model/run_record.hpp"

#include <chrono>
#include <csignal>
#include <list>
#include <memory>

namespace treacle::study {

// A run that is ready to be started.
struct LaneTask {
    std::int64_t number = 0;
    std::filesystem::path folder; // of the request; its run's tables are in folder/run
    std::vector<std::string> command;
    std::vector<std::string> environment; // added to that of this process, "NAME=value"
    int oom_score = run_oom_score;
};

// Why a lane ended its run; `none`: the run ended by itself.
enum class LaneEnd { none, time_limit, hang, memory, stop };

// End of a run, with what it took.
struct LaneResult {
    std::int64_t number = 0;     // of the run
    Ending ending;               // of its program
    LaneEnd end = LaneEnd::none; // other than `none`: the program was ended
    double seconds = 0;          // of the clock
    double peak_bytes = 0;       // of memory, as sampled
    int lane = 0;                // 0 to count() - 1
    std::string started;         // UTC
};

// A run beyond one of these limits is ended.
struct LaneLimits {
    double time = 0;        // [s] of the clock a run; 0: none
    double hang_factor = 0; // mean steps without a row in steps.csv; 0: none
    double hang_least =
        60;            // [s]; before the first step, and behind the last while the run is evaluated, ten times as long
    double memory = 0; // [bytes] a run; 0: none
};

// Progress of a running run, from the last row of its steps.csv.
struct LaneProgress {
    std::int64_t number = 0;
    double steps = 0, time = 0; // [s] simulated
    double seconds = 0;         // [s] of the clock
};

// Runs several programs at once, each in a process of its own: a crash, a hang or a kill for memory stays in it.
// Signals to stop this process (SIGINT, SIGTERM, SIGHUP) are caught while the object exists; `stop_asked` returns them.
class Lanes {
public:
    Lanes(int count, const LaneLimits& limits);
    ~Lanes();
    Lanes(const Lanes&) = delete;
    Lanes& operator=(const Lanes&) = delete;

    // Numbers of lanes, and of those without a run; idle: all are free.
    int count() const { return count_; }
    int free() const { return count_ - int(running_.size()); }
    bool idle() const { return running_.empty(); }
    // On a free lane. Throws SimulationError when the program cannot be started.
    void start(const LaneTask& task);
    // Ends a run at once, without a result.
    void discard(std::int64_t number);
    // Blocks until a run has ended, a stop is requested, or the time [s] is over.
    std::vector<LaneResult> wait(double seconds);
    bool stop_asked() const { return stop_asked_; }
    // Sends all runs SIGTERM; those that still go on after the grace [s] are killed.
    std::vector<LaneResult> stop(double grace);
    std::vector<LaneProgress> progress();

private:
    using Clock = std::chrono::steady_clock;
    struct Running {
        LaneTask task;
        std::unique_ptr<ChildProcess> process;
        Clock::time_point start, last_step;
        int lane = 0;
        std::string started;
        double peak_bytes = 0, steps = 0, time = 0;
        std::uintmax_t size = 0; // of steps.csv [bytes]
        LaneEnd end = LaneEnd::none;
        Clock::time_point told; // to end
    };
    void look_at(Running& run);
    void end(Running& run, LaneEnd why);
    std::vector<LaneResult> collect();

    int count_;
    LaneLimits limits_;
    std::list<Running> running_;
    sigset_t waited_{}, earlier_{};
    bool stop_asked_ = false;
    Clock::time_point last_look_;
};

// "2026-11-25T21:04:05.123Z"
std::string utc_now();

} // namespace treacle::study
