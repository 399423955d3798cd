#pragma once
// Private to src/video: small changes of a pose, (w, t): R <- exp([w]) R, t <- t + dt, in camera axes.
#include "video/camera/camera_file.hpp"

#include <opencv2/core.hpp>
#include <vector>

namespace treacle::video {

using PoseMatrix = cv::Matx66d;        // [6][6] information or covariance, in the order of PoseVector
using PoseVector = cv::Vec<double, 6>; // w [rad] about the camera's axes x, y, z, then t [m]

// Jacobian of a pixel by a change of the pose, of a point [m] of the scene in front of the camera.
cv::Matx<double, 2, 6> pixel_jacobian(const scene::CameraModel& camera, const Vec3& point);
// Jacobian of a pixel by the intrinsic parameters in the order of intrinsic_names().
cv::Matx<double, 2, 12> lens_jacobian(const scene::CameraModel& camera, const Vec3& point);

scene::CameraPose changed(const scene::CameraPose& pose, const PoseVector& change); // exp([w]) R, t + dt

// The same 36 numbers in the other type.
PoseMatrix matrix_of(const PoseCovariance& covariance);
PoseCovariance covariance_of(const PoseMatrix& matrix);

// Inverse of a symmetric positive matrix, scaled to a unit diagonal before. `worst` gets the smallest eigenvalue of the
// scaled matrix: 0 where a direction is not seen.
PoseMatrix inverse(const PoseMatrix& m, double* worst = nullptr);

} // namespace treacle::video
