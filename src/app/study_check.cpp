#include "app/study_check.hpp"

#include "app/experiments.hpp"
#include "app/study_memory.hpp"
#include "app/sweep.hpp"
#include "base/text.hpp"

#include <cstdio>
#include <fstream>
#include <set>

namespace treacle::app {

namespace {
void row(const std::string& name, const std::string& text) { std::printf("  %-28s %s\n", name.c_str(), text.c_str()); }

std::string values_of(const study::Parameter& parameter) {
    const auto& ends = parameter.range;
    return ends.empty() ? join(parameter.values, ", ") : ends.front() + " to " + ends.back() + (parameter.scale == study::Scale::log ? ", log" : "");
}

void print_runs(const identify::StudyFile& file) {
    const auto& study = file.study;
    if (study.sweep.design == study::Design::none) return;
    const auto candidates = sweep_candidates(file);
    study::check_launcher(study);
    std::set<std::string> keys;
    for (const auto& one : candidates) keys.insert(one.key);
    std::printf("sweep\n");
    row("runs", std::to_string(keys.size()) + ", " + std::to_string(study::lane_count(study.runs)) + " at once with " +
                    std::to_string(study.runs.ranks) + " ranks each");
    row("memory of a run", "about " + format_bytes(std::uint64_t(largest_run_memory(study, candidates))) + "; " +
                               format_bytes(std::uint64_t(available_memory())) + " are free here");
    check_memory(study, candidates);
}
} // namespace

bool is_study(const std::filesystem::path& file) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("scenes:")) return true;
    }
    return false;
}

void check_study(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    const auto checked = load_checked_study(file, overrides);
    const auto& study = checked.study;
    std::printf("study%s%s\n", study.title.empty() ? "" : ": ", study.title.c_str());
    for (const auto& scene : study.scenes) row("scene " + scene.name, study.scene_file(scene).string());
    for (const auto& one : study.parameters) row("parameter " + one.name, one.key + ": " + values_of(one));
    for (const auto& one : study.measured) row("measured " + one.name, one.key + ": " + one.value + " +- " + one.plus_minus);
    for (const auto& one : study.read) row("figure " + one.name, one.measurement.empty() ? one.table + ": " + one.column : one.measurement);
    for (const auto& one : checked.experiments) row("experiment " + one.name, describe_observations(checked, one));
    if (!checked.experiments.empty()) identify::check_searched(checked, StudyScenes(checked).reader());
    print_runs(checked);
}

} // namespace treacle::app
