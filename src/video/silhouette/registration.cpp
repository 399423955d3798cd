#include "video/silhouette/registration.hpp"

#include "base/median.hpp"
#include "video/mask/pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {
constexpr std::size_t most_points = 20000;
constexpr int cell = 16;             // points are spread: some of each cell of the picture [px]
constexpr float min_gradient = 1.2F; // [grey levels / px], above noise
constexpr double least_information =
    2e3; // sum of squared gradients in the weaker direction, for a few hundredths of a pixel

constexpr double least_change = 8; // of a point, or what it changes by in one pixel [grey levels of 255]

cv::Mat smooth_grey_of(const Image& image) {
    cv::Mat grey;
    cv::cvtColor(pixels_of(image), grey, cv::COLOR_RGB2GRAY);
    grey.convertTo(grey, CV_32F);
    // Takes out noise that would bias gradients.
    cv::GaussianBlur(grey, grey, {5, 5}, 1.0, 1.0, cv::BORDER_REPLICATE);
    return grey;
}

float sample(const cv::Mat& grey, double x, double y) {
    const int i = int(x), j = int(y);
    const auto u = float(x - i), v = float(y - j);
    const float* a = grey.ptr<float>(j) + i;
    const float* b = grey.ptr<float>(j + 1) + i;
    return (1 - v) * ((1 - u) * a[0] + u * a[1]) + v * ((1 - u) * b[0] + u * b[1]);
}

} // namespace

double FrameShift::largest(int width, int height) const {
    return std::hypot(x, y) + std::abs(angle) * std::hypot(width, height) / 2;
}

Registration::Registration(const Image& reference, const std::vector<unsigned char>& usable)
    : width_(reference.width), height_(reference.height) {
    cv::setNumThreads(1);
    const cv::Mat grey = smooth_grey_of(reference);
    std::vector<Point> found;
    const auto in_cell =
        std::max<std::size_t>(4, most_points / (std::size_t(width_ / cell + 1) * std::size_t(height_ / cell + 1)));
    std::vector<Point> here;
    for (int top = 4; top < height_ - 4; top += cell)
        for (int left = 4; left < width_ - 4; left += cell) {
            here.clear();
            for (int y = top; y < std::min(top + cell, height_ - 4); ++y)
                for (int x = left; x < std::min(left + cell, width_ - 4); ++x) {
                    if (!usable.empty() && usable[std::size_t(y) * std::size_t(width_) + std::size_t(x)] == 0) continue;
                    const float gx = (grey.at<float>(y, x + 1) - grey.at<float>(y, x - 1)) / 2;
                    const float gy = (grey.at<float>(y + 1, x) - grey.at<float>(y - 1, x)) / 2;
                    if (gx * gx + gy * gy < min_gradient * min_gradient) continue;
                    const float u = float(x) - float(width_ - 1) / 2, v = float(y) - float(height_ - 1) / 2;
                    here.push_back({float(x), float(y), grey.at<float>(y, x), gx, gy, -v * gx + u * gy});
                }
            const auto kept = std::min(in_cell, here.size());
            std::ranges::partial_sort(here, here.begin() + std::ptrdiff_t(kept), [](const Point& a, const Point& b) {
                const auto s = [](const Point& p) { return p.gx * p.gx + p.gy * p.gy; };
                return s(a) != s(b) ? s(a) > s(b) : a.y != b.y ? a.y < b.y : a.x < b.x;
            });
            points_.insert(points_.end(), here.begin(), here.begin() + std::ptrdiff_t(kept));
        }
    double xx = 0, xy = 0, yy = 0;
    for (const auto& p : points_) {
        xx += double(p.gx) * double(p.gx);
        xy += double(p.gx) * double(p.gy);
        yy += double(p.gy) * double(p.gy);
    }
    const double weaker = (xx + yy) / 2 - std::hypot((xx - yy) / 2, xy);
    possible_ = points_.size() >= 100 && weaker > least_information;
}

FrameShift Registration::find(const Image& frame, const FrameShift& start) const {
    FrameShift shift = start;
    shift.known = possible_;
    if (!possible_) return shift;
    const cv::Mat grey = smooth_grey_of(frame);
    const double cx = (width_ - 1) / 2.0, cy = (height_ - 1) / 2.0;
    std::vector<double> residuals(points_.size());
    std::vector<double> ratios;
    for (int round = 0; round < 12; ++round) {
        const double cosine = std::cos(shift.angle), sine = std::sin(shift.angle);
        std::vector<float> seen(points_.size(), -1);
        ratios.clear();
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const double u = double(points_[i].x) - cx, v = double(points_[i].y) - cy;
            const double x = cx + cosine * u - sine * v + shift.x, y = cy + sine * u + cosine * v + shift.y;
            if (x < 0 || y < 0 || x >= width_ - 1 || y >= height_ - 1) continue;
            seen[i] = sample(grey, x, y);
            if (points_[i].level > 8) ratios.push_back(double(seen[i]) / double(points_[i].level));
        }
        shift.gain = ratios.empty() ? 1 : upper_median(ratios);
        if (!(shift.gain > 0)) shift.gain = 1;
        std::vector<double> sizes;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            residuals[i] = double(seen[i]) / shift.gain - double(points_[i].level);
            if (seen[i] >= 0) sizes.push_back(std::abs(residuals[i]));
        }
        // Tukey's constant times the robust standard deviation.
        const double cut = 4.685 * std::max(1.0, 1.4826 * upper_median(sizes));
        cv::Matx33d normal = cv::Matx33d::zeros();
        cv::Vec3d right(0, 0, 0);
        std::size_t outside = 0, counted = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            if (seen[i] < 0) continue;
            ++counted;
            const double r = residuals[i] / cut;
            const double steep = std::hypot(double(points_[i].gx), double(points_[i].gy));
            if (std::abs(residuals[i]) > std::max(least_change, steep)) ++outside;
            if (std::abs(r) >= 1) continue;
            const double weight = (1 - r * r) * (1 - r * r);
            const cv::Vec3d g(points_[i].gx, points_[i].gy, points_[i].gt);
            normal += weight * (g * g.t());
            right += weight * residuals[i] * g;
        }
        shift.changed = counted > 0 ? double(outside) / double(counted) : 1;
        cv::Vec3d step;
        if (!cv::solve(normal, right, step, cv::DECOMP_CHOLESKY)) {
            shift.known = false;
            return shift;
        }
        shift.x -= step[0];
        shift.y -= step[1];
        shift.angle -= step[2];
        if (std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]) * width_ < 2e-3) break;
    }
    return shift;
}

Image undo_shift(const Image& frame, const FrameShift& shift) {
    if (!shift.known || shift.largest(frame.width, frame.height) < 0.02) return frame;
    const double cx = (frame.width - 1) / 2.0, cy = (frame.height - 1) / 2.0;
    const double c = std::cos(shift.angle), s = std::sin(shift.angle);
    const cv::Matx23d map(c, -s, cx - c * cx + s * cy + shift.x, s, c, cy - s * cx - c * cy + shift.y);
    cv::Mat moved;
    cv::warpAffine(pixels_of(frame), moved, map, {frame.width, frame.height}, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
        cv::BORDER_REPLICATE);
    return rgb_image_of(moved);
}

} // namespace treacle::video
