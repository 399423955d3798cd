#pragma once
#include "video/image.hpp"
#include "video/mask.hpp"

namespace treacle::video {

// The frame with the mask's contour in red, and its excluded pixels darkened. Cut to an even size, which codecs need.
Image draw_contour(const Image& frame, const Mask& mask);

} // namespace treacle::video
