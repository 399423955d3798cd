#pragma once
#include "app/video_commands.hpp"

namespace treacle::app {

// Receives what turns the words of a subcommand into the command: on ranks, and in a process without MPI.
struct ChooseStudyCommand {
    ChooseCommand on_ranks;
    std::function<void(std::function<ExitCode()>)> alone;
};

// Adds sweep and forward to the program.
void add_study_commands(CLI::App& program, const ChooseStudyCommand& choose);

// True when a launcher of MPI (mpiexec, srun with its own) has started this process.
bool started_on_ranks();

} // namespace treacle::app
