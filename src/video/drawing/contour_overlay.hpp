#pragma once
#include "video/mask/mask.hpp"
#include "video/picture/colour.hpp"
#include "video/picture/image.hpp"

namespace treacle::video {

// The frame with the mask's contour in red, and its excluded pixels darkened. Cut to an even size, which codecs need.
Image draw_contour(const Image& frame, const Mask& mask);

inline constexpr Rgb8 observed_colour{40, 110, 255}, simulated_colour{255, 40, 20};
// The frame with the contours of an observed and a simulated mask, the latter on top. Cut to an even size. All have one size.
Image draw_contours(const Image& frame, const Mask& observed, const Mask& simulated);

} // namespace treacle::video
