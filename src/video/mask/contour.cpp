#include "video/mask/contour.hpp"

#include "base/text/contract.hpp"
#include "video/picture/photo.hpp"

#include "base/text/error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {

constexpr int rim = 3;         // [pixels]
constexpr int turn_length = 4; // [points] to either side over which the normal's turn is measured

cv::Mat matrix_of(const Mask& mask) {
    cv::setNumThreads(1);
    return {mask.height, mask.width, CV_8U, const_cast<std::uint8_t*>(mask.pixels.data())};
}

// Value and gradient of a smooth field by central differences of bilinear values.
struct Level {
    cv::Mat field; // CV_32F

    double at(double x, double y) const {
        const int c = std::clamp(int(std::floor(x)), 0, field.cols - 2),
                  r = std::clamp(int(std::floor(y)), 0, field.rows - 2);
        const double u = x - c, v = y - r;
        const auto f = [&](int row, int column) { return double(field.at<float>(row, column)); };
        return (1 - v) * ((1 - u) * f(r, c) + u * f(r, c + 1)) + v * ((1 - u) * f(r + 1, c) + u * f(r + 1, c + 1));
    }
    scene::Vec2 gradient(double x, double y) const {
        constexpr double h = 0.75;
        return {(at(x + h, y) - at(x - h, y)) / (2 * h), (at(x, y + h) - at(x, y - h)) / (2 * h)};
    }
};

// Moves a point along the gradient to the half level.
bool settle(const Level& level, ContourPoint& point) {
    for (int round = 0; round < 8; ++round) {
        const auto g = level.gradient(point.pixel[0], point.pixel[1]);
        const double gg = g[0] * g[0] + g[1] * g[1];
        if (gg < 1e-6) return false;
        const double step = std::clamp((0.5 - level.at(point.pixel[0], point.pixel[1])) / gg, -4.0, 4.0);
        point.pixel = {point.pixel[0] + step * g[0], point.pixel[1] + step * g[1]};
        point.normal = {-g[0] / std::sqrt(gg), -g[1] / std::sqrt(gg)};
    }
    return std::abs(level.at(point.pixel[0], point.pixel[1]) - 0.5) < 0.01;
}

bool is_corner(const std::vector<ContourPoint>& points, std::size_t i, double sharpest) {
    const std::size_t n = points.size(), k = std::size_t(turn_length);
    const auto& before = points[(i + n - k) % n].normal;
    const auto& after = points[(i + k) % n].normal;
    return before[0] * after[0] + before[1] * after[1] < std::cos(sharpest * std::numbers::pi / 180);
}

bool near_rim(const Mask& mask, const scene::Vec2& p) {
    return p[0] < rim || p[1] < rim || p[0] > mask.width - 1 - rim || p[1] > mask.height - 1 - rim;
}

} // namespace

namespace {

// True where most pixels of the picture's border are light.
bool has_light_border(const Mask& mask) {
    int light = 0, total = 0;
    for (int row = 0; row < mask.height; ++row)
        for (int column = 0; column < mask.width; ++column) {
            if (row > 0 && row + 1 < mask.height && column > 0 && column + 1 < mask.width) continue;
            light += mask.pixels[std::size_t(row) * mask.width + column] > 127;
            ++total;
        }
    return 2 * light > total;
}

} // namespace

Silhouette read_silhouette(const std::filesystem::path& path) {
    auto read = read_photo(path);
    if (const auto* unreadable = std::get_if<Unreadable>(&read))
        throw InputError({path.string(), "cannot be read as a mask", unreadable->reason,
            "give a PNG with a silhouette in black or white"});
    auto& photo = std::get<Photo>(read);
    Mask mask{photo.width, photo.height, std::move(photo.grey)};
    const bool dark_silhouette = has_light_border(mask);
    for (auto& value : mask.pixels) value = (value > 127) != dark_silhouette ? mask_liquid : mask_background;
    if (mask.area() == 0)
        throw InputError({path.string(), "holds no silhouette", "all of its pixels have one tone",
            "give the mask of another frame"});
    return {path.filename().string(), std::move(mask)};
}

std::vector<ContourPoint> find_contour(const Mask& mask, const ContourOptions& options) {
    const cv::Mat binary = matrix_of(mask);
    Level level;
    binary.convertTo(level.field, CV_32F, 1.0 / 255);
    cv::GaussianBlur(level.field, level.field, {0, 0}, options.blur, options.blur, cv::BORDER_REPLICATE);
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(binary, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
    double largest = 0;
    for (const auto& outline : outlines) largest = std::max(largest, cv::contourArea(outline));
    std::vector<ContourPoint> out;
    int piece = 0;
    for (const auto& outline : outlines) {
        if (cv::contourArea(outline) < options.least_part * largest || outline.size() < 4 * std::size_t(turn_length))
            continue;
        std::vector<ContourPoint> points;
        for (const auto& p : outline) {
            ContourPoint point{{double(p.x), double(p.y)}, {0, 0}, piece};
            if (settle(level, point)) points.push_back(point);
        }
        if (points.size() < 4 * std::size_t(turn_length)) continue;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (!near_rim(mask, points[i].pixel) && !is_corner(points, i, options.sharpest)) out.push_back(points[i]);
        ++piece;
    }
    return out;
}

double overlap(const Mask& a, const Mask& b) {
    TREACLE_EXPECT(a.width == b.width && a.height == b.height);
    std::size_t both = 0, any = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        both += a.pixels[i] && b.pixels[i];
        any += a.pixels[i] || b.pixels[i];
    }
    return any > 0 ? double(both) / double(any) : 0;
}

} // namespace treacle::video
