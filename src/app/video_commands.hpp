#pragma once
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <functional>

namespace CLI {
class App;
}

namespace treacle::app {

// Receives what turns the words of a subcommand into the command, when all is read.
using ChooseCommand = std::function<void(std::function<std::function<ExitCode(const Comm&)>()>)>;

// Adds check-video, silhouettes and film to the program.
void add_video_commands(CLI::App& program, const ChooseCommand& choose);

} // namespace treacle::app
