#pragma once
#include "scene/camera/camera_model.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace treacle::video {

// A point of the scene whose pixel is known.
struct ScenePoint {
    Vec3 position{0, 0, 0}; // [m]
    scene::Vec2 pixel{0, 0};
    double deviation = 0; // [pixels] standard deviation of each coordinate; 0: not stated
    std::string where;    // "points.csv:3"
};

// A table with a header: x, y, z, each with its unit in brackets, as in "x [cm]" (metres without one), u, v [pixels] and
// optionally s, the standard deviation of u and v; see NumberTable. InputError with file and line.
std::vector<ScenePoint> read_scene_points(const std::filesystem::path& path);

} // namespace treacle::video
