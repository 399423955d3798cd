#pragma once
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <functional>
#include <string>
#include <vector>

namespace treacle::app {

// Request of the command line.
struct CommandLine {
    std::string petsc;                            // options for PETSc
    std::function<ExitCode(const Comm&)> command; // collective
    std::function<ExitCode()> alone; // in its place where neither MPI nor a launcher is there: it starts processes
};

// Commands that may do without MPI: whether the arguments name one.
bool may_go_alone(const std::vector<std::string>& arguments);

// The same on every rank. Throws InputError for an unknown command or option, with the nearest known one.
// Help and version are commands that print.
CommandLine read_command_line(const std::vector<std::string>& arguments);

} // namespace treacle::app
