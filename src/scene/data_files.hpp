#pragma once
#include "scene/scene.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace treacle::scene {

// The folders in which files named by a scene are looked up, in this order: the scene file's own, those of
// `--data`, and those that the environment variable TREACLE_DATA lists, separated by ':'.
std::vector<std::filesystem::path> data_search_path(
    const std::filesystem::path& scene_file, const std::vector<std::filesystem::path>& data_folders);

// The first of these folders that has the file, or an empty path. An absolute name is looked up as it is.
std::filesystem::path find_data_file(
    const std::filesystem::path& name, const std::vector<std::filesystem::path>& search_path);

// Gives every mesh of the scene the absolute path of its file and no fallback, or replaces it by its fallback. Returns a
// sentence for each replacement. Throws InputError for all that are missing without a fallback, with the
// folders that were searched.
std::vector<std::string> resolve_data_files(Scene& scene, const std::vector<std::filesystem::path>& search_path);

// The files of the scene's meshes, sorted, each once: absolute after resolve_data_files().
std::vector<std::string> mesh_files(const Scene& scene);

} // namespace treacle::scene
