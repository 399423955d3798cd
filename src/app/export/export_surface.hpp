#pragma once
#include "base/text/error.hpp"
#include "mpi/comm.hpp"

#include <filesystem>
#include <string>

namespace treacle::app {

// Arguments of `treacle export --to surface`.
struct SurfaceRequest {
    std::filesystem::path source; // a run's folder
    std::string format = "ply";   // "ply", "obj", "vtp"
    std::string frames;           // see FrameRange
    std::filesystem::path out;    // default: the run's folder exports/
    double min_volume = 0;        // closed surfaces that enclose less are dropped, in volumes of a particle
    std::string liquid;           // the name of the one whose surface is written, "each"; "": all together
    std::string fields;           // see SurfaceFields
    std::string box;              // lower and upper corner of the part that is written; "": all
    bool check = false;           // whether the mesh is closed, oriented and a manifold
};

// `treacle export --to surface`: a mesh of the liquid's surface for each frame, and an index of them. Collective; all
// ranks make each frame together. ExitCode::simulation_failed when a check finds a fault. Throws InputError, SimulationError.
ExitCode export_surface(const Comm& comm, const SurfaceRequest& request);

} // namespace treacle::app
