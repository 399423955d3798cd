#pragma once
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <chrono>
#include <functional>

namespace treacle::app {

// Collective: runs a command and returns its exit code, or that of the error that it throws on any rank: the
// same on every rank. Rank 0 prints the error. When one rank throws and the others block elsewhere, in
// a collective call of the command, the program is ended on all of them after a timeout.
ExitCode run_collectively(const Comm& comm, const std::function<ExitCode()>& command,
    std::chrono::seconds timeout = std::chrono::seconds(30));

} // namespace treacle::app
