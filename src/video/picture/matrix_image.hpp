#pragma once
// Private to src/video.
#include "video/picture/image.hpp"

#include <opencv2/core.hpp>

namespace treacle::video {

// Pictures as OpenCV keeps them, blue first, and back. InputError when the pixels do not fit the size.
cv::Mat matrix_of(const Image& image);
Image image_of(const cv::Mat& blue_first);

} // namespace treacle::video
