#pragma once
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <filesystem>
#include <string>

namespace treacle::app {

// Arguments of `treacle export` for particles.
struct ExportRequest {
    std::filesystem::path source; // a run's folder, or one frame
    std::string format;           // "ply", "vtp", "csv"
    std::string frames;           // see FrameRange
    std::filesystem::path out;    // default: the run's folder exports/, or beside the frame
};

// `treacle export`. Collective; the frames are shared out over the ranks. Throws InputError, SimulationError.
ExitCode export_frames(const Comm& comm, const ExportRequest& request);

} // namespace treacle::app
