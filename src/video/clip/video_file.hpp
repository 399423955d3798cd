#pragma once
#include "video/clip/frame_source.hpp"

namespace treacle::video {

// A video by FFmpeg's libraries. Opening scans all packets: the stamps, and where the file is cut off, are known
// before the first frame is decoded. InputError as open_any_frames().
std::unique_ptr<FrameSource> open_video_file(const SourceRequest& request);

} // namespace treacle::video
