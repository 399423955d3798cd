#pragma once
#include "base/text/error.hpp"
#include "base/text/vec3.hpp"
#include "mpi/comm.hpp"
#include "video/clip/frame_source.hpp"

#include <filesystem>
#include <string>

namespace treacle::app {

// Arguments of `treacle check-video`.
struct CheckVideoRequest {
    video::SourceRequest source; // opened by video::open_any_frames
    std::filesystem::path json;  // the figures; none when empty
    std::string camera;          // a camera file, or FILE:NAME; none when empty
    Vec3 at{0, 0, 0};            // where the liquid is, in the scene [m]
};

// `treacle check-video`: what a clip is like and what is wrong with it. Exit code 2 where it cannot be used. Collective;
// rank 0 works. Throws InputError for what is no clip.
ExitCode check_video(const Comm& comm, const CheckVideoRequest& request);

} // namespace treacle::app
