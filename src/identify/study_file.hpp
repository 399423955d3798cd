#pragma once
#include "identify/experiment.hpp"
#include "study/study.hpp"

namespace treacle::identify {

// A study file whole: the runs, and the films that they are compared with.
struct StudyFile {
    study::Study study;
    std::vector<Experiment> experiments;
    SearchSettings search;

    void declare(Declaration& d);

    const study::StudyScene& scene_of(const Experiment& experiment) const;
    // Absolute.
    std::filesystem::path beside(const std::string& name) const;
};

// Throws InputError with all that is wrong in the file itself.
StudyFile load_study_file(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

// The manual of the study file, and its JSON Schema.
std::string study_manual(const std::string& key);
std::string study_schema();

} // namespace treacle::identify
