#include "video/mask/mask.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"
#include "video/clip/picture_sequence.hpp"
#include "video/mask/pixels.hpp"
#include "video/picture/codecs.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

std::size_t Mask::area() const { return static_cast<std::size_t>(std::ranges::count(pixels, mask_liquid)); }

std::string mask_name(std::int64_t frame) {
    auto number = std::to_string(frame);
    number.insert(0, number.size() < 6 ? 6 - number.size() : 0, '0');
    return "mask_" + number + ".png";
}

void write_mask(const std::filesystem::path& path, const Mask& mask) {
    std::vector<std::uint8_t> bytes;
    if (!codecs().encode_png(pixels_of(mask), bytes))
        throw SimulationError({path.string(), "cannot encode a PNG", "OpenCV lacks it", "install its image codecs"});
    write_file_atomically(path, std::string(bytes.begin(), bytes.end()));
}

Mask read_mask(const std::filesystem::path& path) {
    if (is_heif(path)) throw heif_refused(path);
    const cv::Mat grey = codecs().read(path.string(), cv::IMREAD_GRAYSCALE);
    if (grey.empty()) throw InputError({path.string(), "is no picture that can be read", "", "PNG is usual"});
    return mask_of(grey);
}

namespace {
// Signed distance of pixel centres from the contour of `liquid`, positive outside. Neighbours of a contour are at 0.5.
cv::Mat signed_distance(const cv::Mat& liquid) {
    cv::Mat outside, inside;
    cv::distanceTransform(liquid == 0, outside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    cv::distanceTransform(liquid, inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    cv::Mat distance(liquid.size(), CV_32F);
    for (int y = 0; y < liquid.rows; ++y)
        for (int x = 0; x < liquid.cols; ++x) {
            const float out = outside.at<float>(y, x), in = inside.at<float>(y, x);
            distance.at<float>(y, x) = out > 0 ? out - 0.5F : 0.5F - in;
        }
    return distance;
}
} // namespace

ContourError compare_contours(const Mask& mask, const Mask& exact) {
    if (mask.width != exact.width || mask.height != exact.height)
        throw InputError({"masks", "of unlike sizes cannot be compared", "", "give masks of one camera"});
    const cv::Mat a = pixels_of(mask) == mask_liquid, b = pixels_of(exact) == mask_liquid;
    const cv::Mat excluded = (pixels_of(mask) == mask_excluded) | (pixels_of(exact) == mask_excluded);
    cv::Mat ignored;
    cv::dilate(excluded, ignored, cv::Mat());
    const cv::Mat distance = signed_distance(b);
    ContourError error;
    double sum = 0, squares = 0;
    std::size_t length = 0;
    const auto visit = [&](int x, int y, int x2, int y2) {
        if (ignored.at<std::uint8_t>(y, x) != 0 || ignored.at<std::uint8_t>(y2, x2) != 0) return;
        if (b.at<std::uint8_t>(y, x) != b.at<std::uint8_t>(y2, x2)) ++length;
        if (a.at<std::uint8_t>(y, x) == a.at<std::uint8_t>(y2, x2)) return;
        const double d = 0.5 * (double(distance.at<float>(y, x)) + double(distance.at<float>(y2, x2)));
        sum += d;
        squares += d * d;
        error.largest = std::max(error.largest, std::abs(d));
        ++error.edges;
    };
    for (int y = 0; y < a.rows; ++y)
        for (int x = 0; x < a.cols; ++x) {
            if (x + 1 < a.cols) visit(x, y, x + 1, y);
            if (y + 1 < a.rows) visit(x, y, x, y + 1);
        }
    const double n = static_cast<double>(std::max<std::size_t>(1, error.edges));
    error.mean = sum / n;
    error.deviation = std::sqrt(std::max(0.0, squares / n - error.mean * error.mean));
    const double both = cv::countNonZero(a & b & ~ignored), either = cv::countNonZero((a | b) & ~ignored);
    error.overlap = either > 0 ? both / either : 1;
    const double excess = cv::countNonZero(a & ~ignored) - cv::countNonZero(b & ~ignored);
    // The staircase of a contour is longer than it by 4 / pi on average over directions.
    error.mean_by_area = length > 0 ? excess / (static_cast<double>(length) * 0.785398) : 0;
    return error;
}

} // namespace treacle::video
