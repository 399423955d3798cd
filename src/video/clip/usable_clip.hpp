#pragma once
#include "base/text/error.hpp"
#include "video/clip/frame_source.hpp"

#include <vector>

namespace treacle::video {

// Why silhouettes cannot be taken from a clip as its header describes it: interlaced, HDR (PQ, HLG), pixels that are not
// square, mirrored. Each with a cure.
std::vector<Diagnostic> reasons_against(const ClipInfo& info);

} // namespace treacle::video
