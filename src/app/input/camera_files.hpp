#pragma once
#include "scene/scene.hpp"

#include <filesystem>
#include <vector>

namespace treacle::app {

// Reads the camera files that a scene names: the lens and pose then stand in the scene itself. InputError with all
// problems: a file that is missing, without pose, with several cameras of which none is named, of another picture size.
void read_camera_files(scene::Scene& scene, const std::vector<std::filesystem::path>& search_path);

// A camera from a file, for `--camera FILE`, or `--camera FILE:NAME` where it holds several.
scene::Camera camera_of_file(const std::string& text);

} // namespace treacle::app
