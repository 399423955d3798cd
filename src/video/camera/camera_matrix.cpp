#include "video/camera/camera_matrix.hpp"

#include "base/text/error.hpp"

#include <cmath>
#include <opencv2/calib3d.hpp>

namespace treacle::video {

cv::Mat camera_matrix(const scene::Lens& lens) {
    return (cv::Mat_<double>(3, 3) << lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
}

cv::Mat distortion_vector(const scene::Lens& lens) {
    cv::Mat out(1, int(lens.distortion.size()), CV_64F);
    for (std::size_t i = 0; i < lens.distortion.size(); ++i) out.at<double>(int(i)) = lens.distortion[i];
    return out;
}

scene::Lens lens_of(const cv::Mat& matrix, const cv::Mat& distortion, int width, int height) {
    scene::Lens lens{width, height, matrix.at<double>(0, 0), matrix.at<double>(1, 1), matrix.at<double>(0, 2),
        matrix.at<double>(1, 2), {}};
    for (std::size_t i = 0; i < lens.distortion.size() && i < distortion.total(); ++i)
        lens.distortion[i] = distortion.at<double>(int(i));
    return lens;
}

cv::Vec3d rotation_of(const scene::CameraPose& pose) {
    const Vec3 v = scene::rotation_vector(pose.rotation);
    return {v[0], v[1], v[2]};
}

cv::Vec3d shift_of(const scene::CameraPose& pose) {
    return {pose.translation[0], pose.translation[1], pose.translation[2]};
}

scene::CameraPose pose_of(const cv::Mat& turn, const cv::Mat& shift) {
    const auto vector = [](const cv::Mat& m) { return Vec3{m.at<double>(0), m.at<double>(1), m.at<double>(2)}; };
    return {scene::rotation_matrix(vector(turn)), vector(shift)};
}

scene::CameraModel unchecked_camera(const scene::Lens& lens, const scene::CameraPose& pose) {
    return {"", lens, pose, scene::Folds::allow};
}

scene::CameraPose pose_from_points(
    const scene::Lens& lens, const std::vector<Vec3>& points, const std::vector<scene::Vec2>& pixels) {
    std::vector<cv::Point3d> object;
    std::vector<cv::Point2d> image;
    object.reserve(points.size());
    image.reserve(pixels.size());
    for (const auto& p : points) object.emplace_back(p[0], p[1], p[2]);
    for (const auto& p : pixels) image.emplace_back(p[0], p[1]);
    const cv::Mat matrix = camera_matrix(lens), distortion = distortion_vector(lens);
    double best = HUGE_VAL;
    cv::Mat turn, shift;
    // Each method fails for some arrangements: planar ones have two poses, iterative needs six points off a plane.
    for (const int method : {cv::SOLVEPNP_SQPNP, cv::SOLVEPNP_EPNP, cv::SOLVEPNP_ITERATIVE, cv::SOLVEPNP_IPPE}) {
        std::vector<cv::Mat> turns, shifts;
        try {
            cv::solvePnPGeneric(
                object, image, matrix, distortion, turns, shifts, false, static_cast<cv::SolvePnPMethod>(method));
        } catch (const cv::Exception&) {
            continue;
        }
        for (std::size_t k = 0; k < turns.size(); ++k) {
            if (!cv::checkRange(turns[k]) || !cv::checkRange(shifts[k])) continue;
            const cv::TermCriteria stop(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 100, 1e-14);
            cv::solvePnPRefineLM(object, image, matrix, distortion, turns[k], shifts[k], stop);
            const auto camera = unchecked_camera(lens, pose_of(turns[k], shifts[k]));
            double sum = 0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const auto p = camera.project(points[i]);
                sum += p.depth < scene::CameraModel::near_plane
                           ? HUGE_VAL
                           : std::pow(p.x - pixels[i][0], 2) + std::pow(p.y - pixels[i][1], 2);
            }
            if (!(sum < best)) continue;
            best = sum;
            turn = turns[k].clone();
            shift = shifts[k].clone();
        }
    }
    if (!std::isfinite(best))
        throw InputError({"", "no pose of the camera projects the points to their pixels",
            "all poses found have points behind the camera",
            "look for points that were mixed up, and for lengths in another unit"});
    return pose_of(turn, shift);
}

} // namespace treacle::video
