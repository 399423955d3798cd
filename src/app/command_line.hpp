#pragma once
#include "base/error.hpp"
#include "mpi/comm.hpp"

#include <functional>
#include <string>
#include <vector>

namespace treacle::app {

// What the command line asks for.
struct CommandLine {
    std::string petsc;                            // options for PETSc
    std::function<ExitCode(const Comm&)> command; // collective
    std::function<ExitCode()> alone;              // in its place where neither MPI nor a launcher is there: it starts processes
};

// The same on every rank. Throws InputError for an unknown command or option, with the nearest known one.
// Help and version are commands that print.
// Whether the arguments name a command that may do without MPI.
bool may_go_alone(const std::vector<std::string>& arguments);

CommandLine read_command_line(const std::vector<std::string>& arguments);

} // namespace treacle::app
