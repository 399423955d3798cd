#include "video/camera/coverage_picture.hpp"

#include "video/camera/camera_matrix.hpp"
#include "video/picture/matrix_image.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {

constexpr int smallest_width = 960; // [pixels] of the drawing

// Coordinates of the camera's pictures to those of the drawing.
struct Scale {
    double factor;
    cv::Point operator()(const scene::Vec2& p) const {
        constexpr int fraction = 16; // cv::line's shift of 4 bits
        return {int(std::lround(((p[0] + 0.5) * factor - 0.5) * fraction)),
            int(std::lround(((p[1] + 0.5) * factor - 0.5) * fraction))};
    }
};
constexpr int shift = 4;

cv::Scalar colour_of(std::size_t i, std::size_t n) {
    cv::Mat hsv(
        1, 1, CV_8UC3, cv::Scalar(std::floor(180.0 * double(i) / double(std::max<std::size_t>(n, 1))), 200, 190)),
        bgr;
    cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
    const auto c = bgr.at<cv::Vec3b>(0, 0);
    return {double(c[0]), double(c[1]), double(c[2])};
}

void shade_empty(cv::Mat& picture, const Coverage& coverage) {
    for (int row = 0; row < Coverage::parts; ++row)
        for (int column = 0; column < Coverage::parts; ++column) {
            if (coverage.points[std::size_t(row)][std::size_t(column)] > 0) continue;
            const auto at = [](int k, int side) { return k * side / Coverage::parts; };
            const cv::Point from(at(column, picture.cols), at(row, picture.rows)),
                to(at(column + 1, picture.cols), at(row + 1, picture.rows));
            cv::rectangle(picture, cv::Rect(from, to), {215, 215, 250}, cv::FILLED);
        }
}

void draw_board(
    cv::Mat& picture, const BoardPicture& board, const Board& size, const Scale& scale, const cv::Scalar& colour) {
    const auto& p = board.view.points;
    const std::size_t w = std::size_t(size.columns), n = p.size();
    const std::array<std::size_t, 4> rim{0, w - 1, n - 1, n - w};
    for (std::size_t i = 0; i < rim.size(); ++i)
        cv::line(picture, scale(p[rim[i]]), scale(p[rim[(i + 1) % 4]]), colour, 1, cv::LINE_AA, shift);
    for (const auto& point : p) cv::circle(picture, scale(point), 3 << shift, colour, cv::FILLED, cv::LINE_AA, shift);
}

void draw_distortion(cv::Mat& picture, const scene::Lens& lens, const Scale& scale) {
    constexpr int n = 13;
    const auto camera = unchecked_camera(lens, {});
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const scene::Vec2 seen{(lens.width - 1) * i / (n - 1.0), (lens.height - 1) * j / (n - 1.0)};
            const auto ray = camera.ray(seen);
            const scene::Vec2 ideal{lens.cx + lens.fx * ray[0], lens.cy + lens.fy * ray[1]};
            cv::line(picture, scale(ideal), scale(seen), {120, 120, 120}, 1, cv::LINE_AA, shift);
            cv::circle(picture, scale(seen), 2 << shift, {120, 120, 120}, cv::FILLED, cv::LINE_AA, shift);
        }
    cv::drawMarker(picture, scale({lens.cx, lens.cy}) / (1 << shift), {0, 0, 0}, cv::MARKER_CROSS, 16, 2, cv::LINE_AA);
}

} // namespace

Image draw_coverage(const Calibration& calibration) {
    cv::setNumThreads(1);
    const auto& lens = calibration.lens;
    const Scale scale{std::max(1.0, std::ceil(double(smallest_width) / lens.width))};
    cv::Mat picture(
        int(scale.factor * lens.height), int(scale.factor * lens.width), CV_8UC3, cv::Scalar(255, 255, 255));
    shade_empty(picture, coverage_of(calibration));
    draw_distortion(picture, lens, scale);
    const auto n = calibration.pictures.size();
    for (std::size_t i = 0; i < n; ++i) {
        const auto& board = calibration.pictures[i];
        if (board.state == PictureState::used || board.state == PictureState::outlier)
            draw_board(picture, board, calibration.board, scale,
                board.state == PictureState::used ? colour_of(i, n) : cv::Scalar(0, 0, 0));
    }
    return image_of(picture);
}

} // namespace treacle::video
