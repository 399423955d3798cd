#pragma once
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <filesystem>

namespace treacle::app {

// `treacle info`: what a frame, a checkpoint, the index of a series, or a run's folder holds. Collective.
// Throws InputError when the path is none of these.
ExitCode show_info(const Comm& comm, const std::filesystem::path& path);

} // namespace treacle::app
