#pragma once
#include "base/error.hpp"
#include "mpi/comm.hpp"

#include <filesystem>
#include <string>

namespace treacle::app {

struct SurfaceRequest {
    std::filesystem::path source;    // a run's folder
    std::string format = "ply";      // "ply", "obj", "vtp"
    std::string frames;              // see FrameRange
    std::filesystem::path out;       // default: the run's folder exports/
    double min_volume = 0;           // closed surfaces that enclose less are dropped, in volumes of a particle
};

// `treacle export --to surface`: a mesh of the liquid's surface for each frame, and an index of them. Collective; all
// ranks make each frame together. Throws InputError, SimulationError.
ExitCode export_surface(const Comm& comm, const SurfaceRequest& request);

} // namespace treacle::app
