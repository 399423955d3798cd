#pragma once
#include "video/camera/calibration.hpp"
#include "video/picture/image.hpp"

namespace treacle::video {

// Coverage by the board: its points by picture, the parts of the picture without any shaded, outlines of the boards,
// and the distortion as arrows of its true length from the image of a point in an undistorted lens.
Image draw_coverage(const Calibration& calibration);

} // namespace treacle::video
