#pragma once
#include "base/text/error.hpp"
#include "video/clip/frame_source.hpp"

namespace treacle::video {

// True when the clip names a folder, a pattern or a single picture rather than a video.
bool names_pictures(const std::filesystem::path& clip);

// Pictures of one size in the order of the numbers in their names, turned upright by their own EXIF data.
// InputError as open_any_frames().
std::unique_ptr<FrameSource> open_pictures(const SourceRequest& request);

// HEIF container (HEIC, the iPhone's stills), by the brand in its first bytes; ISO/IEC 23008-12.
bool is_heif(const std::filesystem::path& path);
InputError heif_refused(const std::filesystem::path& path);

} // namespace treacle::video
