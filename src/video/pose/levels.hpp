#pragma once
#include "video/pose/pose.hpp"

#include <filesystem>
#include <vector>

namespace treacle::video {

// A pixel of which it is known in which plane of the scene the point lies that is seen there.
struct PlanePixel {
    scene::Vec2 pixel{0, 0};
    int axis = 0;      // of the plane's normal: 0 x, 1 y, 2 z
    double offset = 0; // [m] of the plane along it
    std::string where; // "level.csv:3"
};

// Lines "u, v, x = 2 cm"; lines that begin with # and a header do not count. InputError with file and line.
std::vector<PlanePixel> read_levels(const std::filesystem::path& path);

// The vertical in the scene's axes.
struct Vertical {
    Vec3 up{0, 0, 1};     // unit
    double deviation = 0; // [rad] largest standard deviation of its direction, of pixels off by `noise` and of the pose
    double residual = 0;  // [m] root mean square distance of the points from the plane or line
};

// From the line where the liquid at rest meets walls: the normal of the plane through at least three points of it.
// InputError for fewer, and for points on one line.
Vertical vertical_of_level(
    const CameraRecord& camera, const std::vector<PlanePixel>& pixels, const Vec3& about, double noise);
// From a plumb line, seen in a plane of the scene in which it hangs: the direction of the line through two points or more.
Vertical vertical_of_plumb(
    const CameraRecord& camera, const std::vector<PlanePixel>& pixels, const Vec3& about, double noise);

} // namespace treacle::video
