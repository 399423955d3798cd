#pragma once
#include "base/text/log.hpp"
#include "mpi/comm.hpp"

#include <filesystem>

namespace treacle::app {

// The part of `treacle info` for a run's folder: how it was made, how far it is, how it ended, its frames and
// checkpoints. Collective. Throws InputError when it is no run's folder.
void show_run(const Comm& comm, const std::filesystem::path& path, Log& log);

} // namespace treacle::app
