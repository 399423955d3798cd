#include "app/study/study_scenes.hpp"

#include "app/compare/experiments.hpp"
#include "base/options/options.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "io/manifest.hpp"
#include "scene/data_files.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

namespace treacle::app {

namespace {
// Hash of a file's content; a study reads its meshes many times over.
const std::string& content_hash(const std::string& path) {
    struct Known {
        std::filesystem::file_time_type time;
        std::string hash;
    };
    static std::map<std::string, Known> known;
    std::error_code ignored;
    const auto time = std::filesystem::last_write_time(path, ignored);
    auto& entry = known[path];
    if (entry.hash.empty() || entry.time != time) {
        std::ifstream file(path, std::ios::binary);
        entry = {time, io::text_hash({std::istreambuf_iterator<char>(file), {}})};
    }
    return entry.hash;
}

void check_readings(
    const study::Study& study, const study::StudyScene& one, const Input& input, std::vector<Diagnostic>& problems) {
    std::vector<std::string> names;
    for (const auto& measurement : input.scene.measurements) names.push_back(measurement.name);
    for (const auto& reading : study.read) {
        if (reading.measurement.empty() || std::ranges::find(names, reading.measurement) != names.end()) continue;
        const auto close = nearest(reading.measurement, names);
        problems.push_back({reading.where, "the scene " + one.name + " has no measurement " + reading.measurement,
            names.empty() ? "it has none at all" : "it has " + join(names, ", "),
            close ? "did you mean " + *close + "?" : "add it to the scene's `measurements`"});
    }
}
} // namespace

StudyScenes::StudyScenes(const identify::StudyFile& file) {
    for (const auto& scene : file.study.scenes) {
        auto needs = scene_needs(file, scene);
        auto& known = needs_[file.study.scene_file(scene)];
        known.content += needs.content;
        known.step_per_spacing = std::max(known.step_per_spacing, needs.step_per_spacing);
        known.assignments.insert(known.assignments.end(), needs.assignments.begin(), needs.assignments.end());
    }
}

InputSource source_of(const std::filesystem::path& scene, const std::vector<study::Assignment>& assignments) {
    InputSource out{scene, {}, {}, {}, {}};
    for (const auto& one : assignments) out.changes.push_back({one.text, one.origin});
    return out;
}

InputSource StudyScenes::source(
    const std::filesystem::path& scene, const std::vector<study::Assignment>& assignments) const {
    auto out = source_of(scene, assignments);
    if (const auto needs = needs_.find(scene); needs != needs_.end()) {
        for (const auto& one : needs->second.assignments) out.changes.push_back({one.text, one.origin});
        if (needs->second.step_per_spacing > 0) {
            const double step =
                needs->second.step_per_spacing * load_scene(source_of(scene, assignments)).scene.domain.spacing;
            out.changes.push_back({"time.step=" + format_number(step), "a share of the time between observations"});
        }
    }
    return out;
}

study::SceneFacts StudyScenes::read(
    const std::filesystem::path& scene, const std::vector<study::Assignment>& assignments) const {
    const auto input = load_scene(source(scene, assignments));
    const auto& domain = input.scene.domain;
    // Particles go with the spacing's power of the dimensions, steps with its inverse.
    study::SceneFacts facts{effective(input), input.scene.time.end,
        input.scene.time.end * std::pow(domain.spacing, -domain.dimensions - 1)};
    for (const auto& file : scene::mesh_files(input.scene)) {
        const auto hash = "content " + content_hash(file);
        for (auto at = facts.content.find(file); at != std::string::npos;
             at = facts.content.find(file, at + hash.size())) {
            facts.content.replace(at, file.size(), hash);
        }
    }
    if (const auto needs = needs_.find(scene); needs != needs_.end()) facts.content += needs->second.content;
    return facts;
}

identify::StudyFile load_checked_study(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
    auto file = identify::load_study_file(path, overrides);
    const auto& study = file.study;
    std::vector<Diagnostic> problems;
    for (const auto& one : study.scenes) {
        const auto scene = study.scene_file(one);
        if (!std::filesystem::exists(scene)) {
            problems.push_back({one.where, "the scene " + scene.string() + " is not there",
                "names of files are taken from the study's folder", "check its name"});
            continue;
        }
        try {
            check_readings(study, one, load_scene({scene, one.set, {}, {}, {}}), problems);
        } catch (const InputError& error) {
            problems.insert(problems.end(), error.diagnostics().begin(), error.diagnostics().end());
        }
    }
    if (!problems.empty()) throw InputError(problems);
    return file;
}

} // namespace treacle::app
