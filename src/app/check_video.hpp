#pragma once
#include "base/error.hpp"
#include "mpi/comm.hpp"
#include "video/frame_source.hpp"

#include <filesystem>

namespace treacle::app {

struct CheckVideoRequest {
    video::SourceRequest source;
    std::filesystem::path json; // the figures; none when empty
};

// `treacle check-video`: what a clip is like and what is wrong with it. Exit code 2 where it cannot be used. Collective;
// rank 0 works. Throws InputError for what is no clip.
ExitCode check_video(const Comm& comm, const CheckVideoRequest& request);

} // namespace treacle::app
