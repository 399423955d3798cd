#pragma once
#include "mpi/comm.hpp"

#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace treacle::app {

// Why a run should end before its time: a signal (SIGTERM, SIGINT, SIGHUP, SIGUSR1), a file named STOP in its folder, or
// the time limit of the clock.
class StopControl {
public:
    StopControl(const Comm& comm, std::filesystem::path stop_file, double wall_limit);
    ~StopControl();
    StopControl(const StopControl&) = delete;
    StopControl& operator=(const StopControl&) = delete;

    // Cause of a stop; with several at once `ask` returns the first in this order.
    enum class Reason { none, signal, stop_file, wall_limit };
    // Collective: the same answer on every rank. One small reduction.
    Reason ask();
    // Removes the file STOP once it has been followed, so that the run may go on. Collective.
    void clear();
    double wall_seconds() const;

private:
    using Handler = void (*)(int);

    Comm comm_;
    std::filesystem::path stop_file_;
    double wall_limit_;
    std::chrono::steady_clock::time_point start_;
    std::vector<std::pair<int, Handler>> earlier_; // handlers by the number of their signal
};

// "a signal", "the file STOP", "the time limit"; "" for none.
std::string describe(StopControl::Reason reason);

} // namespace treacle::app
