#pragma once
#include "app/input.hpp"
#include "study/study_runs.hpp"

namespace treacle::app {

// A scene with the values that a run of a study sets in it.
InputSource source_of(const std::filesystem::path& scene, const std::vector<study::Assignment>& assignments);

// What a study needs to know of its scenes: with names of files go their contents, not where they are.
study::SceneFacts read_study_scene(const std::filesystem::path& scene, const std::vector<study::Assignment>& assignments);

// A study of which the keys that it sets and the figures that it reads are there in every scene. Throws InputError.
study::Study load_checked_study(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

} // namespace treacle::app
