#include "app/study/study_check.hpp"

#include "app/compare/experiments.hpp"
#include "app/study/flow_lengths.hpp"
#include "app/study/measured_fractions.hpp"
#include "app/study/study_memory.hpp"
#include "app/study/sweep.hpp"
#include "base/text/text.hpp"

#include <cstdio>
#include <fstream>
#include <set>

namespace treacle::app {

namespace {
void row(const std::string& name, const std::string& text) { std::printf("  %-32s %s\n", name.c_str(), text.c_str()); }

void print_lines(const std::vector<LabelledLine>& lines) {
    for (const auto& [name, text] : lines) {
        if (name.empty()) {
            std::printf("%s\n", text.c_str());
        } else {
            row(name, text);
        }
    }
}

std::string values_of(const study::Parameter& parameter) {
    const auto& ends = parameter.range;
    return ends.empty() ? join(parameter.values, ", ")
                        : ends.front() + " to " + ends.back() + (parameter.scale == study::Scale::log ? ", log" : "");
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

// Takes out the experiments of which no film is there yet, with a message.
void leave_out_unfilmed(identify::StudyFile& file) {
    const auto source = [&](const identify::Experiment& one) {
        if (one.kind == identify::ExperimentKind::piv) return file.beside(one.piv.files.front());
        return file.beside(one.kind == identify::ExperimentKind::series ? one.series.file : one.masks);
    };
    const auto unfilmed = [&](const identify::Experiment& one) {
        return one.kind != identify::ExperimentKind::piv && !std::filesystem::exists(source(one));
    };
    for (const auto& one : file.experiments)
        row("experiment " + one.name, source(one).string() + (unfilmed(one) ? " (not there yet)" : ""));
    std::erase_if(file.experiments, unfilmed);
}

// Spacings of the coarsest and the finest rung; an empty one is the scene's own.
std::vector<std::string> outer_spacings(const identify::StudyFile& file) {
    const auto& rungs = file.search.rungs;
    if (rungs.empty()) return {""};
    if (rungs.size() == 1) return {rungs.front()};
    return {rungs.front(), rungs.back()};
}

// Narrow places of each scene's flow, with the measured values and where the search starts, at the coarsest and the finest spacing.
void print_flow_lengths(const identify::StudyFile& file) {
    std::vector<std::string> given;
    for (std::size_t i = 0; i < file.searched + file.measured; ++i) {
        const auto& one = file.study.parameters[i];
        if (i >= file.searched || !one.start.empty())
            given.push_back(one.key + "=" + (i < file.searched ? one.start : one.values.front()));
    }
    for (const auto& scene : file.study.scenes) {

        for (const auto& spacing : outer_spacings(file)) {
            auto set = scene.set;
            set.insert(set.end(), given.begin(), given.end());
            if (!spacing.empty()) set.push_back("domain.spacing=" + spacing);
            std::printf("flow of %s%s\n", scene.name.c_str(), spacing.empty() ? "" : (", spacing " + spacing).c_str());
            print_lines(flow_length_lines(load_scene({file.study.scene_file(scene), set, {}, {}, {}})));
        }
    }
}
} // namespace

bool is_study(const std::filesystem::path& file) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with("scenes:")) return true;
    }
    return false;
}

namespace {

void print_inputs(const identify::StudyFile& checked) {
    const auto& study = checked.study;
    for (std::size_t i = 0; i < checked.searched; ++i)
        row("parameter " + study.parameters[i].name, study.parameters[i].key + ": " + values_of(study.parameters[i]));
    for (const auto& one : study.measured)
        row("measured " + one.name, one.key + ": " + one.value + " +- " + one.plus_minus);
    for (const auto& one : study.read)
        row("figure " + one.name, one.measurement.empty() ? one.table + ": " + one.column : one.measurement);
}

} // namespace

void check_study(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    auto checked = load_checked_study(file, overrides);
    const auto& study = checked.study;
    std::printf("study%s%s\n", study.title.empty() ? "" : ": ", study.title.c_str());
    for (const auto& scene : study.scenes) row("scene " + scene.name, study.scene_file(scene).string());
    const bool identifies = !checked.experiments.empty();
    print_inputs(checked);
    if (identifies) {
        const auto measured = measured_fractions(checked, study_folder(study.path, {}) / "report" / "result.yaml");
        leave_out_unfilmed(checked);
        for (const auto& one : checked.experiments) row("experiment " + one.name, describe_observations(checked, one));
        identify::check_searched(checked, StudyScenes(checked).reader());
        print_lines(measured);
        print_flow_lengths(checked);
    }
    print_runs(checked);
}

} // namespace treacle::app
