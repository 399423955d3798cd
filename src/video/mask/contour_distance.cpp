#include "video/mask/contour_distance.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {
constexpr double blur = 1.5; // [px] as of ContourOptions, so that both contours are rounded alike

cv::Mat liquid_of(const Mask& mask) {
    cv::Mat out(mask.height, mask.width, CV_8U);
    for (int row = 0; row < mask.height; ++row) {
        for (int column = 0; column < mask.width; ++column)
            out.at<std::uint8_t>(row, column) = mask.liquid(column, row) ? 255 : 0;
    }
    return out;
}

double bilinear(const cv::Mat& field, double x, double y) {
    const int c = std::clamp(int(std::floor(x)), 0, field.cols - 2),
              r = std::clamp(int(std::floor(y)), 0, field.rows - 2);
    const double u = std::clamp(x - c, 0.0, 1.0), v = std::clamp(y - r, 0.0, 1.0);
    const auto f = [&](int row, int column) { return double(field.at<float>(row, column)); };
    return (1 - v) * ((1 - u) * f(r, c) + u * f(r, c + 1)) + v * ((1 - u) * f(r + 1, c) + u * f(r + 1, c + 1));
}
} // namespace

struct ContourDistance::Fields {
    cv::Mat level;           // blurred, 0 to 1
    cv::Mat inside, outside; // [px] to the nearest pixel of the other kind
    bool empty = false, full = false;
    double diagonal = 0;
};

ContourDistance::ContourDistance(const Mask& mask, double band) : fields_(std::make_unique<Fields>()), band_(band) {
    cv::setNumThreads(1);
    const cv::Mat liquid = liquid_of(mask);
    const int count = cv::countNonZero(liquid);
    fields_->diagonal = std::hypot(mask.width, mask.height);
    fields_->empty = count == 0;
    fields_->full = count == int(mask.pixels.size());
    liquid.convertTo(fields_->level, CV_32F, 1.0 / 255);
    cv::GaussianBlur(fields_->level, fields_->level, {0, 0}, blur, blur, cv::BORDER_REPLICATE);
    cv::distanceTransform(liquid, fields_->inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    cv::distanceTransform(255 - liquid, fields_->outside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
}

ContourDistance::~ContourDistance() = default;

double ContourDistance::nearest(const ContourPoint& point) const {
    const auto& f = *fields_;
    if (f.empty) return -f.diagonal;
    if (f.full) return f.diagonal;
    const double x = point.pixel[0], y = point.pixel[1];
    // The contour lies half a pixel before the nearest pixel's centre.
    return bilinear(f.level, x, y) >= 0.5 ? bilinear(f.inside, x, y) - 0.5 : 0.5 - bilinear(f.outside, x, y);
}

double ContourDistance::operator()(const ContourPoint& point) const {
    const auto& f = *fields_;
    const double far = nearest(point);
    if (f.empty || f.full) return far;
    if (std::abs(far) > band_) return along_normal(point, far);
    const double x = point.pixel[0], y = point.pixel[1];
    // Along the normal to the half level, from the point on.
    constexpr double step = 0.5;
    const auto level = [&](double s) {
        return bilinear(f.level, x + s * point.normal[0], y + s * point.normal[1]) - 0.5;
    };
    const double direction = level(0) >= 0 ? 1 : -1;
    double s = 0, before = level(0);
    while (std::abs(s) < band_ + 2) {
        const double next = s + direction * step, value = level(next);
        if ((value >= 0) != (before >= 0)) return s + direction * step * before / (before - value);
        s = next;
        before = value;
    }
    return far;
}

// From one distance to the next, each as far as there surely is no contour, up to the picture's rim.
double ContourDistance::along_normal(const ContourPoint& point, double far) const {
    const auto& f = *fields_;
    const double direction = far > 0 ? 1 : -1;
    const cv::Mat& clear = far > 0 ? f.inside : f.outside;
    double rim = f.diagonal;
    for (std::size_t k = 0; k < 2; ++k) {
        const double way = direction * point.normal[k], size = k == 0 ? clear.cols - 1 : clear.rows - 1;
        if (way != 0) rim = std::min(rim, ((way > 0 ? size : 0) - point.pixel[k]) / way);
    }
    const double most = far > 0 ? rim : std::min(rim, 4 * std::abs(far));
    for (double s = 0; s < most;) {
        const double x = point.pixel[0] + direction * s * point.normal[0],
                     y = point.pixel[1] + direction * s * point.normal[1];
        if ((bilinear(f.level, x, y) >= 0.5) != (far > 0)) return direction * s;
        s += std::max(0.5, bilinear(clear, x, y) - 1);
    }
    return far > 0 ? std::max(far, rim) : far;
}

} // namespace treacle::video
