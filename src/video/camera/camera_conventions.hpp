#pragma once
// Private to src/video: cameras of other programs.
#include "video/camera/camera_file.hpp"

namespace treacle::video {

bool is_colmap(const std::filesystem::path& path); // true for cameras.txt and for a folder that holds it
// COLMAP's text model, a record for each picture in images.txt, positions in its units. InputError with file and line.
std::vector<CameraRecord> read_colmap(const std::filesystem::path& path);

bool is_virheometry(const std::string& content); // true for the elements of its camera_params.xml
// ViRheometry's camera_params.xml, lengths in cm there; one record. InputError naming the element.
std::vector<CameraRecord> read_virheometry(const std::filesystem::path& path, const std::string& content);

// Camera from an eye point [m], a quaternion (w, x, y, z) camera to world in OpenGL's axes, and a vertical field of
// view [rad], the principal point in the middle of the picture.
struct OpenGlCamera {
    Vec3 eye{0, 0, 0};                            // [m] in the scene's axes
    std::array<double, 4> quaternion{1, 0, 0, 0}; // w, x, y, z of any length; camera to world
    double vertical_field_of_view = 0.7;          // [rad], in (0, pi)
    int width = 0, height = 0;
};
scene::Lens lens_of(const OpenGlCamera& camera);
scene::CameraPose pose_of(const OpenGlCamera& camera);

// Rotation matrix of a quaternion (w, x, y, z) of any length.
scene::Matrix3 matrix_of(const std::array<double, 4>& quaternion);

} // namespace treacle::video
