#include "study/candidates.hpp"

#include "base/text/error.hpp"
#include "io/manifest.hpp"

#include <algorithm>

namespace treacle::study {

std::vector<Assignment> assignments_of(
    const Study& study, const StudyScene& scene, const Point& values, const std::vector<std::string>& changes) {
    std::vector<Assignment> out;
    for (const auto& text : scene.set) out.push_back({text, scene.where + ": set " + text});
    for (const auto& one : study.measured) out.push_back({one.key + "=" + one.value, one.where + ": " + one.name});
    for (std::size_t i = 0; i < study.parameters.size(); ++i) {
        const auto& parameter = study.parameters[i];
        out.push_back(
            {parameter.key + "=" + values.at(i), parameter.where + ": " + parameter.name + " = " + values[i]});
    }
    for (const auto& text : changes) out.push_back({text, "change of the run: " + text});
    return out;
}

std::string program_identity() {
    const auto build = io::build_info();
    return "treacle " + build.version + " (" + build.commit + ", " + build.state + ", " + build.compiler + ", " +
           build.type + ")";
}

std::string run_key(const SceneFacts& facts, int ranks, const std::string& program) {
    return io::text_hash(program + "\nranks " + std::to_string(ranks) + "\n" + facts.content);
}

JournalOwner owner_of(const Study& study, const std::string& program) {
    std::string text;
    for (const auto& scene : study.scenes) text += "scene " + scene.name + "\n";
    for (const auto& parameter : study.parameters) text += "parameter " + parameter.name + " " + parameter.key + "\n";
    return {io::text_hash(text), program};
}

Candidate candidate_of(const Study& study, const StudyScene& scene, const Point& values, const SceneReader& read_scene,
    const std::vector<std::string>& changes) {
    const auto facts = read_scene(study.scene_file(scene), assignments_of(study, scene, values, changes));
    return {scene.name, values, run_key(facts, study.runs.ranks, program_identity()), facts.end, facts.work, changes};
}

namespace {
// "study.yaml:6: viscosity = -10 Pa.s" as far as the name.
std::string without_values(const std::string& text) { return text.substr(0, text.find(" = ")); }
} // namespace

std::vector<Candidate> candidates_of(
    const Study& study, const std::vector<Point>& points, const SceneReader& read_scene) {
    std::vector<Candidate> out;
    std::vector<Diagnostic> problems;
    for (const auto& point : points) {
        for (const auto& scene : study.scenes) {
            try {
                out.push_back(candidate_of(study, scene, point, read_scene));
            } catch (const InputError& error) {
                // A fault of a key at every point is reported once, with the first value.
                for (const auto& problem : error.diagnostics()) {
                    const bool known = std::ranges::any_of(problems, [&](const Diagnostic& one) {
                        return without_values(one.where) == without_values(problem.where) &&
                               without_values(one.problem) == without_values(problem.problem);
                    });
                    if (!known) problems.push_back(problem);
                }
            }
        }
    }
    if (!problems.empty()) throw InputError(problems);
    return out;
}

} // namespace treacle::study
