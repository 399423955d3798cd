#pragma once
// Private to src/video: cameras of other programs.
#include "video/camera/camera_file.hpp"

namespace treacle::video {

bool is_colmap(const std::filesystem::path& path);
std::vector<CameraRecord> read_colmap(const std::filesystem::path& path);

bool is_virheometry(const std::string& content);
std::vector<CameraRecord> read_virheometry(const std::filesystem::path& path, const std::string& content);

// Camera from an eye point [m], a quaternion (w, x, y, z) camera to world in OpenGL's axes, and a vertical field of
// view [rad], the principal point in the middle of the picture.
struct OpenGlCamera {
    Vec3 eye{0, 0, 0};
    std::array<double, 4> quaternion{1, 0, 0, 0};
    double vertical_field_of_view = 0.7;
    int width = 0, height = 0;
};
scene::Lens lens_of(const OpenGlCamera& camera);
scene::CameraPose pose_of(const OpenGlCamera& camera);

// Rotation matrix of a quaternion (w, x, y, z) of any length.
scene::Matrix3 matrix_of(const std::array<double, 4>& quaternion);

} // namespace treacle::video
