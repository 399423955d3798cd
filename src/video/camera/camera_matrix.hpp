#pragma once
// Private to src/video: cameras as OpenCV takes them.
#include "scene/camera/camera_model.hpp"

#include <opencv2/core.hpp>
#include <vector>

namespace treacle::video {

cv::Mat camera_matrix(const scene::Lens& lens);     // [3][3]
cv::Mat distortion_vector(const scene::Lens& lens); // [8]
// From a 3 x 3 matrix and 0, 4, 5 or 8 coefficients.
scene::Lens lens_of(const cv::Mat& matrix, const cv::Mat& distortion, int width, int height);

cv::Vec3d rotation_of(const scene::CameraPose& pose); // rotation vector
cv::Vec3d shift_of(const scene::CameraPose& pose);    // translation [m]
// turn: rotation vector [3] [rad]; shift: translation [3] [m]; CV_64F.
scene::CameraPose pose_of(const cv::Mat& turn, const cv::Mat& shift);

// During a fit the distortion may fold the picture over; the caller must check that.
scene::CameraModel unchecked_camera(const scene::Lens& lens, const scene::CameraPose& pose);

// Pose that projects points [m] to pixels with the least squares of distances: cv::solvePnP, refined by
// Levenberg-Marquardt. InputError when there is none in front of the camera.
scene::CameraPose pose_from_points(
    const scene::Lens& lens, const std::vector<Vec3>& points, const std::vector<scene::Vec2>& pixels);

} // namespace treacle::video
