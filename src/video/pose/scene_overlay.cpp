#include "video/pose/scene_overlay.hpp"

#include "base/text/error.hpp"
#include "video/camera/camera_matrix.hpp"
#include "video/drawing/overlay.hpp"
#include "video/picture/codecs.hpp"
#include "video/picture/colour.hpp"
#include "video/picture/matrix_image.hpp"
#include "video/picture/vector.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {

constexpr int shift = 4; // fractional bits of OpenCV's coordinates
constexpr double tint = 0.22;

const cv::Scalar liquid_colour(255, 140, 30), body_colour(30, 140, 255), box_colour(150, 150, 150),
    outline_colour(255, 255, 255);

cv::Mat read_colour(const std::filesystem::path& path) {
    cv::setNumThreads(1);
    cv::Mat out = codecs().read(path.string(), cv::IMREAD_COLOR);
    if (out.empty()) {
        const auto read = read_photo(path); // throws for a bad one
        const auto* unreadable = std::get_if<Unreadable>(&read);
        throw InputError(
            {path.string(), "cannot be read as a picture", unreadable ? unreadable->reason : "", "give a PNG or JPEG"});
    }
    return out;
}

cv::Point fixed(double x, double y) { return {int(std::lround(x * (1 << shift))), int(std::lround(y * (1 << shift)))}; }

struct Pen {
    cv::Scalar colour;
    int width;
};

// A straight edge of the scene, bent by the lens.
void draw_edge(cv::Mat& picture, const scene::CameraModel& camera, const Vec3& from, const Vec3& to, const Pen& pen) {
    constexpr int pieces = 64;
    std::optional<cv::Point> last;
    for (int k = 0; k <= pieces; ++k) {
        const auto p = camera.project(mix(from, to, double(k) / pieces));
        const bool seen = p.depth > 1e-3 && std::abs(p.x) < 30000 && std::abs(p.y) < 30000;
        const std::optional<cv::Point> here = seen ? std::optional(fixed(p.x, p.y)) : std::nullopt;
        if (last && here) cv::line(picture, *last, *here, pen.colour, pen.width, cv::LINE_AA, shift);
        last = here;
    }
}

void draw_domain(cv::Mat& picture, const scene::CameraModel& camera, const DomainBox& box) {
    const auto corner = [&](int i) {
        return Vec3{
            (i & 1) ? box.max[0] : box.min[0], (i & 2) ? box.max[1] : box.min[1], (i & 4) ? box.max[2] : box.min[2]};
    };
    for (int i = 0; i < 8; ++i)
        for (const int bit : {1, 2, 4})
            if (!(i & bit)) draw_edge(picture, camera, corner(i), corner(i | bit), {box_colour, 1});
}

void draw_axes(cv::Mat& picture, const scene::CameraModel& camera, double length) {
    const cv::Scalar colours[3] = {{40, 40, 230}, {40, 180, 40}, {230, 80, 40}};
    for (std::size_t k = 0; k < 3; ++k) {
        Vec3 end{0, 0, 0};
        end[k] = length;
        draw_edge(picture, camera, {0, 0, 0}, end, {colours[k], 2});
    }
}

// Tints the pixels of each solid and draws the borders between what is seen.
void draw_solids(cv::Mat& picture, const SolidPicture& seen, const SceneOverlay& overlay) {
    cv::Mat borders = cv::Mat::zeros(picture.size(), CV_8U);
    const auto colour_of = [&](int number) {
        return overlay.kinds[std::size_t(number)] == OverlayKind::liquid ? liquid_colour : body_colour;
    };
    const auto number = [&](int row, int column) { return seen.number[std::size_t(row) * seen.width + column]; };
    cv::Mat lines = picture.clone();
    for (int row = 0; row < seen.height; ++row)
        for (int column = 0; column < seen.width; ++column) {
            const int own = number(row, column);
            const int right = column + 1 < seen.width ? number(row, column + 1) : own,
                      below = row + 1 < seen.height ? number(row + 1, column) : own;
            auto& pixel = picture.at<cv::Vec3b>(row, column);
            if (own >= 0) {
                const auto colour = colour_of(own);
                for (int k = 0; k < 3; ++k)
                    pixel[k] = cv::saturate_cast<std::uint8_t>((1 - tint) * pixel[k] + tint * colour[k]);
            }
            const int other = own != right ? right : below;
            if (own == other) continue;
            const auto colour = colour_of(std::max(own, other));
            borders.at<std::uint8_t>(row, column) = 255;
            lines.at<cv::Vec3b>(row, column) =
                cv::Vec3b(std::uint8_t(colour[0]), std::uint8_t(colour[1]), std::uint8_t(colour[2]));
        }
    // Lines about one five-hundredth of the picture wide.
    const int width = std::max(1, seen.width / 900);
    const cv::Mat brush = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * width - 1, 2 * width - 1});
    for (int row = 0; row < seen.height; ++row)
        for (int column = 0; column < seen.width; ++column) {
            if (!borders.at<std::uint8_t>(row, column)) continue;
            const auto c = lines.at<cv::Vec3b>(row, column);
            cv::circle(picture, {column, row}, width - 1, cv::Scalar(c[0], c[1], c[2]), cv::FILLED);
        }
}

void draw_outline(cv::Mat& picture, const Mask& mask) {
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(cv::Mat(mask.height, mask.width, CV_8U, const_cast<std::uint8_t*>(mask.pixels.data())), outlines,
        cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
    cv::drawContours(picture, outlines, -1, {0, 0, 0}, 3);
    cv::drawContours(picture, outlines, -1, outline_colour, 1);
}

} // namespace

Image draw_overlay(const CameraRecord& camera, const std::filesystem::path& frame, const SceneOverlay& overlay) {
    cv::Mat picture = read_colour(frame);
    const auto model = for_pictures(camera, picture.cols, picture.rows, frame.string()).model();
    draw_solids(picture, look_at(model, overlay.solids), overlay);
    if (overlay.domain.dimensions == 3) draw_domain(picture, model, overlay.domain);
    if (overlay.silhouette) draw_outline(picture, *overlay.silhouette);
    draw_axes(picture, model, 0.15 * length(overlay.domain.max - overlay.domain.min));
    Image image = image_of(picture);
    if (!overlay.caption.empty()) draw_caption(image, overlay.caption, {255, 220, 0});
    return image;
}

Image draw_board_axes(const std::filesystem::path& path, const Board& board, const BoardView& view) {
    cv::Mat picture = read_colour(path);
    const auto& p = view.points;
    const std::size_t w = std::size_t(board.columns), n = p.size();
    for (const auto& point : p)
        cv::circle(picture, fixed(point[0], point[1]), 4 << shift, {0, 200, 0}, 1, cv::LINE_AA, shift);
    const int width = std::max(2, picture.cols / 300);
    const auto at = [&](std::size_t i) { return cv::Point(int(std::lround(p[i][0])), int(std::lround(p[i][1]))); };
    cv::arrowedLine(picture, at(0), at(w - 1), {40, 40, 230}, width, cv::LINE_AA, 0, 0.05);
    cv::arrowedLine(picture, at(0), at(n - w), {40, 180, 40}, width, cv::LINE_AA, 0, 0.05);
    cv::circle(picture, at(0), 4 * width, {0, 220, 255}, width, cv::LINE_AA);
    Image image = image_of(picture);
    draw_caption(image, "first point yellow, x red, y green, z away from the viewer", {255, 220, 0});
    return image;
}

} // namespace treacle::video
