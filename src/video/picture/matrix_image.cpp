#include "video/picture/matrix_image.hpp"

#include "base/text/error.hpp"

#include <opencv2/imgproc.hpp>

namespace treacle::video {

cv::Mat matrix_of(const Image& image) {
    cv::setNumThreads(1);
    if (image.width < 1 || image.height < 1 ||
        image.pixels.size() != 3 * std::size_t(image.width) * std::size_t(image.height))
        throw InputError({"picture", "its pixels do not fit its size", "", "give [height][width][3] bytes"});
    const cv::Mat rgb(image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.pixels.data()));
    cv::Mat bgr;
    cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
    return bgr;
}

Image image_of(const cv::Mat& blue_first) {
    cv::Mat rgb;
    cv::cvtColor(blue_first, rgb, blue_first.channels() == 1 ? cv::COLOR_GRAY2RGB : cv::COLOR_BGR2RGB);
    return {rgb.cols, rgb.rows, std::vector<std::uint8_t>(rgb.datastart, rgb.dataend)};
}

} // namespace treacle::video
