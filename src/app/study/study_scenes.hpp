#pragma once
#include "app/compare/observation_needs.hpp"
#include "app/input/input.hpp"
#include "identify/experiment/study_file.hpp"
#include "study/study_runs.hpp"

#include <map>

namespace treacle::app {

// Reads the scenes of a study with what the experiments that they are compared with need.
class StudyScenes {
public:
    // Throws InputError for observations that do not fit their scene.
    explicit StudyScenes(const identify::StudyFile& file);

    // Facts of a scene for a study: with names of files go their contents, not where they are.
    study::SceneFacts read(const std::filesystem::path& scene, const std::vector<study::Assignment>& assignments) const;
    // The scene of a run, with what its experiments need.
    InputSource source(const std::filesystem::path& scene, const std::vector<study::Assignment>& assignments) const;
    study::SceneReader reader() const {
        return [this](const std::filesystem::path& scene, const std::vector<study::Assignment>& assignments) {
            return read(scene, assignments);
        };
    }

private:
    std::map<std::filesystem::path, ObservationNeeds> needs_;
};

// The scene of a run as it is without experiments.
InputSource source_of(const std::filesystem::path& scene, const std::vector<study::Assignment>& assignments);

// A study of which the keys that it sets and the figures that it reads are there in every scene. Throws InputError.
identify::StudyFile load_checked_study(
    const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

} // namespace treacle::app
