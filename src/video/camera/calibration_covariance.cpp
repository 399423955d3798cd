#include "video/camera/calibration_covariance.hpp"

#include "video/camera/camera_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/calib3d.hpp>

namespace treacle::video {

namespace {

constexpr int pose_parameters = 6;

std::vector<int> fitted_parameters(int coefficients) {
    std::vector<int> out(std::size_t(4 + coefficients));
    std::iota(out.begin(), out.end(), 0);
    return out;
}

// Jacobian of pixels by pose and by all intrinsic parameters, [2 n][6] and [2 n][12], and residuals [2 n].
struct Linearised {
    cv::Mat pose, lens, residual;
};

Linearised linearise(const scene::Lens& lens, const scene::CameraPose& pose, const std::vector<Vec3>& points,
    const std::vector<scene::Vec2>& pixels) {
    std::vector<cv::Point3d> object;
    object.reserve(points.size());
    for (const auto& p : points) object.emplace_back(p[0], p[1], p[2]);
    std::vector<cv::Point2d> seen;
    cv::Mat jacobian;
    cv::projectPoints(
        object, rotation_of(pose), shift_of(pose), camera_matrix(lens), distortion_vector(lens), seen, jacobian);
    cv::Mat residual(int(2 * points.size()), 1, CV_64F);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        residual.at<double>(int(2 * i)) = pixels[i][0] - seen[i].x;
        residual.at<double>(int(2 * i + 1)) = pixels[i][1] - seen[i].y;
    }
    return {jacobian.colRange(0, pose_parameters),
        jacobian.colRange(pose_parameters, pose_parameters + int(intrinsic_count)), residual};
}

// Addition of a picture to the normal equations of the lens when its pose is eliminated (Schur complement).
struct Reduced {
    cv::Mat matrix, gradient; // [p][p], [p][1]
    double squares = 0;
    int equations = 0;
};

struct Normal {
    std::vector<int> fitted;
    std::vector<Reduced> pictures;
    cv::Mat matrix;      // sum, [p][p]
    double variance = 0; // of one coordinate of a point, if all were independent
};

Normal reduce(const Calibration& calibration) {
    Normal out;
    out.fitted = fitted_parameters(calibration.options.coefficients);
    const int p = int(out.fitted.size());
    out.matrix = cv::Mat::zeros(p, p, CV_64F);
    const auto points = board_points(calibration.board);
    double squares = 0;
    int freedom = -p;
    for (const auto& picture : calibration.pictures) {
        if (picture.state != PictureState::used) continue;
        const auto linear = linearise(calibration.lens, picture.pose, points, picture.view.points);
        const cv::Mat lens = linear.lens.colRange(0, p);
        const cv::Mat pose = (linear.pose.t() * linear.pose).inv(cv::DECOMP_SVD);
        const cv::Mat across = lens.t() * linear.pose;
        Reduced reduced{lens.t() * lens - across * pose * across.t(),
            lens.t() * linear.residual - across * pose * (linear.pose.t() * linear.residual),
            linear.residual.dot(linear.residual), linear.residual.rows};
        out.matrix += reduced.matrix;
        squares += reduced.squares;
        freedom += reduced.equations - pose_parameters;
        out.pictures.push_back(std::move(reduced));
    }
    out.variance = squares / std::max(freedom, 1);
    return out;
}

// Parameters differ in size by 1e3: scaled to a unit diagonal before they are inverted.
cv::Mat inverse(const cv::Mat& m) {
    cv::Mat scale = cv::Mat::zeros(m.size(), CV_64F);
    for (int i = 0; i < m.rows; ++i) scale.at<double>(i, i) = 1 / std::sqrt(std::max(m.at<double>(i, i), 1e-300));
    return scale * cv::Mat(scale * m * scale).inv(cv::DECOMP_SVD) * scale;
}

IntrinsicCovariance expand(const cv::Mat& m, const std::vector<int>& fitted) {
    IntrinsicCovariance out;
    for (int i = 0; i < m.rows; ++i)
        for (int j = 0; j < m.cols; ++j) out.at(std::size_t(fitted[i]), std::size_t(fitted[j])) = m.at<double>(i, j);
    return out;
}

} // namespace

IntrinsicCovariance independent_covariance(const Calibration& calibration) {
    const auto normal = reduce(calibration);
    return expand(normal.variance * inverse(normal.matrix), normal.fitted);
}

IntrinsicCovariance jackknife_covariance(const Calibration& calibration) {
    const auto normal = reduce(calibration);
    const double n = double(normal.pictures.size());
    cv::Mat spread = cv::Mat::zeros(normal.matrix.size(), CV_64F);
    for (const auto& picture : normal.pictures) {
        // Change of the optimum when this picture is left out.
        const cv::Mat change = inverse(normal.matrix - picture.matrix) * picture.gradient;
        spread += (n - 1) / n * change * change.t();
    }
    const cv::Mat independent = normal.variance * inverse(normal.matrix);
    // Raised where independent errors alone make more: D A D with the correlations of A.
    cv::Mat raise = cv::Mat::zeros(spread.size(), CV_64F);
    for (int i = 0; i < spread.rows; ++i)
        raise.at<double>(i, i) =
            std::sqrt(std::max(1.0, independent.at<double>(i, i) / std::max(spread.at<double>(i, i), 1e-300)));
    return expand(raise * spread * raise, normal.fitted);
}

double ray_deviation(const Calibration& calibration) {
    constexpr int n = 9;
    const auto& lens = calibration.lens;
    const scene::CameraModel camera = unchecked_camera(lens, {});
    std::vector<Vec3> points;
    std::vector<scene::Vec2> pixels;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            pixels.push_back({(lens.width - 1) * i / (n - 1.0), (lens.height - 1) * j / (n - 1.0)});
            points.push_back(camera.unproject(pixels.back(), 1));
        }
    const auto linear = linearise(lens, {}, points, pixels);
    const cv::Mat turn = linear.pose.colRange(0, 3);
    const cv::Mat moved = linear.lens - turn * ((turn.t() * turn).inv(cv::DECOMP_SVD) * (turn.t() * linear.lens));
    constexpr int all = static_cast<int>(intrinsic_count);
    const cv::Mat covariance(all, all, CV_64F, const_cast<double*>(calibration.covariance.values.data()));
    double largest = 0;
    for (int k = 0; k < n * n; ++k) {
        const cv::Mat rows = moved.rowRange(2 * k, 2 * k + 2);
        const cv::Mat c = rows * covariance * rows.t();
        const double half = 0.5 * (c.at<double>(0, 0) + c.at<double>(1, 1));
        const double apart = std::hypot(0.5 * (c.at<double>(0, 0) - c.at<double>(1, 1)), c.at<double>(0, 1));
        largest = std::max(largest, half + apart);
    }
    return std::sqrt(largest);
}

} // namespace treacle::video
