#include "identify/study_file.hpp"

#include "base/document.hpp"
#include "base/options.hpp"

#include <algorithm>

namespace treacle::identify {

void StudyFile::declare(Declaration& d) {
    study.declare(d);
    d.list("experiments", experiments, "Films that the runs are compared with, for `treacle identify`.");
    d.block("search", search, "How `treacle identify` looks for the parameters.", "method");
    if (!d.parsing()) return;
    for (std::size_t i = 0; i < experiments.size(); ++i) {
        const auto& one = experiments[i];
        const bool known = one.scene.empty() || std::ranges::find(study.scenes, one.scene, &study::StudyScene::name) != study.scenes.end();
        d.check(known, "experiments", {"must name scenes of the study", one.where + ": there is no scene " + one.scene, "give the name of one under `scenes`"});
        for (std::size_t k = 0; k < i; ++k) {
            d.check(experiments[k].name != one.name, "experiments",
                    {"must have names that differ", one.where + ": " + one.name + " stands at " + experiments[k].where + " too", "give one of them another name"});
        }
    }
}

const study::StudyScene& StudyFile::scene_of(const Experiment& experiment) const {
    if (experiment.scene.empty()) return study.scenes.front();
    return *std::ranges::find(study.scenes, experiment.scene, &study::StudyScene::name);
}

std::filesystem::path StudyFile::beside(const std::string& name) const {
    const std::filesystem::path path = name;
    return (path.is_absolute() ? path : study.path.parent_path() / path).lexically_normal();
}

StudyFile load_study_file(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
    auto document = Document::load(path);
    for (const auto& assignment : overrides) document.set(assignment);
    StudyFile out;
    out.study.path = std::filesystem::absolute(path).lexically_normal();
    parse(document, out);
    return out;
}

std::string study_manual(const std::string& key) { return manual(StudyFile{}, key); }
std::string study_schema() { return json_schema(StudyFile{}); }

} // namespace treacle::identify
