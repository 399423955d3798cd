#pragma once
#include "video/mask/mask.hpp"
#include "video/picture/image.hpp"

#include <vector>

namespace treacle::video {

// A frame at the brightness of the background, and what was found.
struct MatchedFrame {
    Image image;
    double gain = 1; // median ratio of the frame's grey levels to those of the background
};

// Takes out the drift of exposure and tone curve: for each channel the ratio of the frame's levels to those of the
// background `mean` [height][width][3] is measured in bands of levels, by medians over pixels that `foreground` (empty:
// none) leaves as background, and interpolated between them. Pixels clipped in both become the background.
MatchedFrame match_brightness(const Image& frame, const std::vector<float>& mean, const Mask& foreground);

} // namespace treacle::video
