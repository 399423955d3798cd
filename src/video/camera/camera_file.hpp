#pragma once
#include "scene/camera/camera_model.hpp"
#include "video/camera/calibration.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace treacle::video {

// Covariance of a pose [6][6], row by row: a small rotation [rad] about the camera's axes x, y, z, R <- exp([w]) R, then
// the translation t [m].
using PoseCovariance = std::array<double, 36>;

// A camera as a file states it.
struct CameraRecord {
    std::string name;
    scene::Lens lens;
    std::optional<scene::CameraPose> pose; // in the scene's axes
    std::optional<IntrinsicCovariance> covariance;
    std::optional<PoseCovariance> pose_covariance;
    double rms = 0;        // [pixels] of the calibration; 0: not stated
    std::string where;     // "camera.yaml, camera left"
    bool any_size = false; // stated by its angle of view: holds for pictures of any size and this shape

    // InputError without a pose.
    scene::CameraModel model() const;
};

// Cameras of a file, by what stands in it:
// - OpenCV's FileStorage (YAML, JSON, XML) and plain YAML of the same keys (ROS): image_width, image_height,
//   camera_matrix, distortion_coefficients of 0, 4, 5 or 8 numbers, optional pose: rotation_vector or rotation_matrix
//   and translation_vector (also rvec, tvec, R, T) [m], world to camera; several cameras as a list `cameras`;
// - ViRheometry's camera_params.xml: eyepos [cm], quat (w, x, y, z) camera to world in OpenGL's axes (x right, y up, z
//   towards the viewer), fov vertical [deg], window_size;
// - COLMAP's text model, the folder or its cameras.txt, with images.txt beside it: one camera per picture, its world
//   taken as the scene's in metres. SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV.
// InputError that names the file and what it lacks.
std::vector<CameraRecord> read_cameras(const std::filesystem::path& path);

// The camera of that name; "": the only one. InputError that lists the names.
CameraRecord read_camera(const std::filesystem::path& path, const std::string& name);

// OpenCV's FileStorage in the format of the extension: .yaml, .yml, .json or .xml. Written as a whole.
void write_cameras(const std::filesystem::path& path, const std::vector<CameraRecord>& cameras);

// The camera for the pictures `where` of width x height pixels: itself, or, of `any_size`, resized. InputError when they
// differ from those of the calibration.
CameraRecord for_pictures(const CameraRecord& camera, int width, int height, const std::string& where);

} // namespace treacle::video
