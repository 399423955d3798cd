#pragma once
// Pictures and masks as OpenCV's matrices, without copies; private to src/video.
#include "video/mask/mask.hpp"
#include "video/picture/image.hpp"

#include <opencv2/core.hpp>

namespace treacle::video {

// Red first, as Image is.
inline cv::Mat pixels_of(const Image& image) {
    return {image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.pixels.data())};
}
inline cv::Mat pixels_of(const Mask& mask) {
    return {mask.height, mask.width, CV_8UC1, const_cast<std::uint8_t*>(mask.pixels.data())};
}
inline Mask mask_of(const cv::Mat& matrix) {
    Mask mask{matrix.cols, matrix.rows, {}};
    mask.pixels.resize(matrix.total());
    matrix.copyTo(pixels_of(mask));
    return mask;
}
inline Image rgb_image_of(const cv::Mat& matrix) {
    Image image{matrix.cols, matrix.rows, {}};
    image.pixels.resize(3 * matrix.total());
    matrix.copyTo(pixels_of(image));
    return image;
}

} // namespace treacle::video
