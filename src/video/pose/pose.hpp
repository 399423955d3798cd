#pragma once
#include "video/camera/camera_file.hpp"
#include "video/camera/scene_points.hpp"

#include <string>
#include <vector>

namespace treacle::video {

// The pose of a camera in the scene, and how well it is known.
struct PoseEstimate {
    scene::CameraPose pose;
    PoseCovariance covariance{};   // see PoseCovariance
    double rms = 0;                // [pixels] of the distances between points and their projections
    double noise = 0;              // [pixels] standard deviation of a coordinate that the covariance takes
    std::vector<double> distances; // [pixels] of each point
    std::vector<std::string> warnings;
};

// Options of pose_of_points.
struct PointPoseOptions {
    double noise = 1; // [pixels] standard deviation expected of points that state none; counts as four points' worth
};

// Pose from four points or more, by least squares weighted with the points' deviations. Covariance: of independent
// errors, whose size is that of the residuals and of what was expected together; the covariance of the lens, where it is
// known, counts as well. InputError for fewer points, points on one line, points outside of the picture, and where no
// pose fits to 20 pixels.
PoseEstimate pose_of_points(
    const CameraRecord& camera, const std::vector<ScenePoint>& points, const PointPoseOptions& options);

// Standard deviation [pixels] of the projection of a point [m] of the scene, from the covariance of the pose: the larger
// axis of its ellipse.
double pixel_deviation(const scene::CameraModel& camera, const PoseCovariance& covariance, const Vec3& point);

} // namespace treacle::video
