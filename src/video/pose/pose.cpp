#include "video/pose/pose.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/camera/camera_matrix.hpp"
#include "video/pose/pose_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

namespace treacle::video {

namespace {

constexpr double prior_points = 4; // weight of the expected noise, in points
constexpr double hopeless = 20;    // [pixels] error above which points were mixed up

void check(const CameraRecord& camera, const std::vector<ScenePoint>& points) {
    if (points.size() < 4)
        throw InputError(
            {points.empty() ? "" : points.front().where, std::to_string(points.size()) + " points do not fix a pose",
                "three have up to four poses", "list at least 4 points, better 8, far apart and not all on one plane"});
    for (const auto& point : points) {
        const auto& [u, v] = point.pixel;
        if (u >= -0.5 && v >= -0.5 && u < camera.lens.width - 0.5 && v < camera.lens.height - 0.5) continue;
        throw InputError({point.where,
            "pixel " + format_number(u) + ", " + format_number(v) + " lies outside of pictures of " +
                std::to_string(camera.lens.width) + " x " + std::to_string(camera.lens.height) + " pixels",
            "", "u runs to the right, v down, from the top left pixel"});
    }
}

// Points on a line leave the turn about it open; `spread` of the middle axis against the longest.
void check_spread(const std::vector<ScenePoint>& points) {
    cv::Mat positions(int(points.size()), 3, CV_64F), covariance, mean, values;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) positions.at<double>(int(i), int(k)) = points[i].position[k];
    cv::calcCovarMatrix(positions, covariance, mean, cv::COVAR_NORMAL | cv::COVAR_ROWS, CV_64F);
    cv::eigen(covariance, values);
    if (values.at<double>(1) > 1e-4 * values.at<double>(0)) return;
    throw InputError({points.front().where, "the points lie on one line", "the turn of the camera about it stays open",
        "add points off the line"});
}

} // namespace

cv::Matx<double, 2, 6> pixel_jacobian(const scene::CameraModel& camera, const Vec3& point) {
    const Vec3 x = camera.to_camera(point), t = camera.pose().translation;
    const double h = 1e-6 * x[2];
    cv::Matx<double, 2, 3> by_point;
    for (std::size_t k = 0; k < 3; ++k) {
        Vec3 low = x, high = x;
        low[k] -= h;
        high[k] += h;
        const auto a = camera.project_camera(low), b = camera.project_camera(high);
        by_point(0, int(k)) = (b.x - a.x) / (2 * h);
        by_point(1, int(k)) = (b.y - a.y) / (2 * h);
    }
    const Vec3 r{x[0] - t[0], x[1] - t[1], x[2] - t[2]}; // R X: w x (R X) is what a turn adds
    const double by_pose[18] = {0, r[2], -r[1], 1, 0, 0, -r[2], 0, r[0], 0, 1, 0, r[1], -r[0], 0, 0, 0, 1};
    return by_point * cv::Matx<double, 3, 6>(by_pose);
}

cv::Matx<double, 2, 12> lens_jacobian(const scene::CameraModel& camera, const Vec3& point) {
    std::vector<cv::Point2d> seen;
    cv::Mat jacobian;
    cv::projectPoints(std::vector<cv::Point3d>{{point[0], point[1], point[2]}}, rotation_of(camera.pose()),
        shift_of(camera.pose()), camera_matrix(camera.lens()), distortion_vector(camera.lens()), seen, jacobian);
    cv::Matx<double, 2, 12> out;
    for (int i = 0; i < 12; ++i)
        for (const int row : {0, 1}) out(row, i) = jacobian.at<double>(row, 6 + i);
    return out;
}

scene::CameraPose changed(const scene::CameraPose& pose, const PoseVector& change) {
    return {scene::product(scene::rotation_matrix({change[0], change[1], change[2]}), pose.rotation),
        {pose.translation[0] + change[3], pose.translation[1] + change[4], pose.translation[2] + change[5]}};
}

PoseMatrix matrix_of(const PoseCovariance& covariance) { return PoseMatrix(covariance.data()); }

PoseCovariance covariance_of(const PoseMatrix& matrix) {
    PoseCovariance out;
    std::copy_n(matrix.val, 36, out.begin());
    return out;
}

PoseMatrix inverse(const PoseMatrix& m, double* worst) {
    PoseMatrix scale = PoseMatrix::zeros();
    for (int i = 0; i < 6; ++i) scale(i, i) = 1 / std::sqrt(std::max(m(i, i), 1e-300));
    const PoseMatrix scaled = scale * m * scale;
    if (worst) {
        cv::Mat values;
        cv::eigen(cv::Mat(scaled), values);
        *worst = values.at<double>(5);
    }
    return scale * scaled.inv(cv::DECOMP_SVD) * scale;
}

namespace {

void check_errors(const PoseEstimate& found, const std::vector<ScenePoint>& points) {
    if (found.rms < hopeless) return;
    const auto worst = std::size_t(std::ranges::max_element(found.distances) - found.distances.begin());
    throw InputError({points[worst].where,
        "no pose fits the points: this one is off by " + format_number(std::round(found.distances[worst])) +
            " pixels, all by " + format_number(std::round(found.rms)) + " on average",
        "points are mixed up, or their unit or the camera is another one", "draw the points on the picture and look"});
}

} // namespace

PoseEstimate pose_of_points(
    const CameraRecord& camera, const std::vector<ScenePoint>& points, const PointPoseOptions& options) {
    check(camera, points);
    check_spread(points);
    std::vector<Vec3> positions;
    std::vector<scene::Vec2> pixels;
    for (const auto& point : points) {
        positions.push_back(point.position);
        pixels.push_back(point.pixel);
    }
    PoseEstimate out;
    out.pose = pose_from_points(camera.lens, positions, pixels);
    PoseMatrix information;
    cv::Matx<double, 6, 12> across;
    double squares = 0;
    // Gauss-Newton with the points' weights; the last round is at the optimum.
    for (int round = 0; round < 20; ++round) {
        const auto model = unchecked_camera(camera.lens, out.pose);
        information = PoseMatrix::zeros();
        across = cv::Matx<double, 6, 12>::zeros();
        PoseVector gradient = PoseVector::all(0);
        squares = 0;
        out.distances.clear();
        for (const auto& point : points) {
            const double weight = std::pow(options.noise / (point.deviation > 0 ? point.deviation : options.noise), 2);
            const auto seen = model.project(point.position);
            const cv::Vec2d residual(point.pixel[0] - seen.x, point.pixel[1] - seen.y);
            const auto jacobian = pixel_jacobian(model, point.position);
            information += weight * jacobian.t() * jacobian;
            across += weight * jacobian.t() * lens_jacobian(model, point.position);
            const cv::Matx<double, 6, 1> part = jacobian.t() * residual;
            for (int i = 0; i < 6; ++i) gradient[i] += weight * part(i);
            squares += weight * residual.dot(residual);
            out.distances.push_back(std::sqrt(residual.dot(residual)));
        }
        const cv::Matx<double, 6, 1> step = inverse(information) * gradient;
        if (round < 19) out.pose = changed(out.pose, PoseVector(step.val));
    }
    for (const double d : out.distances) out.rms += d * d / double(points.size());
    out.rms = std::sqrt(out.rms);
    check_errors(out, points);
    const double freedom = 2.0 * double(points.size()) - 6, prior = 2 * prior_points;
    out.noise = std::sqrt((squares + prior * options.noise * options.noise) / (freedom + prior));
    double seen = 0;
    const PoseMatrix inverted = inverse(information, &seen);
    PoseMatrix covariance = out.noise * out.noise * inverted;
    if (camera.covariance) {
        const cv::Matx<double, 6, 12> by_lens = inverted * across;
        covariance += by_lens * cv::Matx<double, 12, 12>(camera.covariance->values.data()) * by_lens.t();
    }
    out.covariance = covariance_of(covariance);
    if (seen < 1e-7)
        out.warnings.push_back("the points hardly fix the pose: take some that are farther apart, at other depths");
    if (out.noise > 3 * options.noise)
        out.warnings.push_back("the points fit to " + format_number(std::round(10 * out.rms) / 10) +
                               " pixels only: one of them may be mistaken, or the lens is another one");
    return out;
}

double pixel_deviation(const scene::CameraModel& camera, const PoseCovariance& covariance, const Vec3& point) {
    const auto jacobian = pixel_jacobian(camera, point);
    const cv::Matx22d c = jacobian * matrix_of(covariance) * jacobian.t();
    return std::sqrt(0.5 * (c(0, 0) + c(1, 1)) + std::hypot(0.5 * (c(0, 0) - c(1, 1)), c(0, 1)));
}

} // namespace treacle::video
