#include "app/study/study_plan.hpp"

#include "app/setup/estimates.hpp"
#include "app/study/study_memory.hpp"
#include "app/study/sweep.hpp"
#include "base/options/options.hpp"
#include "base/text/csv_reader.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

namespace treacle::app {

namespace {
constexpr double coarsening = 1.5; // of the spacing, in the measured run

const study::StudyScene& scene_of(const study::Study& study, const std::string& name) {
    return *std::ranges::find(study.scenes, name, &study::StudyScene::name);
}

// The study of the coarse run alone, in a folder of its own. A study that varies the spacing is not made coarser.
identify::StudyFile coarse_study(
    const study::Study& study, const study::Candidate& candidate, double spacing, const std::filesystem::path& folder) {
    auto out = study;
    out.scenes = {scene_of(study, candidate.scene)};
    auto& scene = out.scenes.front();
    scene.file = study.scene_file(scene).string();
    const bool varied =
        std::ranges::any_of(study.parameters, [](const auto& one) { return one.key == "domain.spacing"; });
    if (!varied) scene.set.push_back("domain.spacing=" + format_number(coarsening * spacing) + " m");
    out.sweep = {};
    out.sweep.design = study::Design::list;
    out.sweep.rows = {join(candidate.values, ", ")};
    out.runs.lanes = 1;
    out.runs.keep = study::Keep::everything;
    out.runs.disk = 0;
    out.runs.reuse.clear();
    std::filesystem::create_directories(folder);
    write_file_atomically(folder / "study.yaml", effective(out));
    return load_checked_study(folder / "study.yaml");
}

MeasuredRun measure(const identify::StudyFile& file, const std::filesystem::path& folder) {
    const auto& study = file.study;
    const auto candidate = sweep_candidates(file).front();
    Log log(LogOutput::disabled);
    study::StudyRuns runs(study, {folder, this_program(), {}}, log);
    const auto number = runs.ask(candidate);
    const auto end = runs.run(std::span(&number, 1), true);
    const auto* outcome = runs.journal().outcome(number);
    if (end == study::StudyEnd::stopped || !outcome || outcome->status != study::RunStatus::done) {
        throw SimulationError({runs.run_folder(number).string(), "the coarse run was not done",
            outcome ? outcome->reason : "it was asked to stop", "its log.txt says more"});
    }
    const auto run = runs.run_folder(number) / "run";
    const auto steps = read_csv(run / "steps.csv");
    MeasuredRun out;
    out.size = run_size(study, candidate);
    out.seconds = outcome->seconds;
    out.steps = double(steps.rows());
    double stepping = 0; // phases, whose columns end in [s], but the simulated times
    for (std::size_t i = 0; i < steps.names.size(); ++i) {
        const auto name = without_unit(steps.names[i]);
        if (!steps.names[i].ends_with("[s]") || name == "time" || name == "dt") continue;
        for (const double value : steps.values[i]) stepping += value;
    }
    out.start_seconds = std::max(0.0, out.seconds - stepping);
    for (const char* table : {"steps.csv", "measurements.csv", "bodies.csv"}) {
        std::error_code none;
        const auto size = std::filesystem::file_size(run / table, none);
        if (!none) out.bytes_by_step += double(size);
    }
    out.bytes_by_frame = folder_bytes(run / "frames");
    out.bytes_fixed = folder_bytes(runs.run_folder(number)) - out.bytes_by_step - out.bytes_by_frame -
                      folder_bytes(run / "checkpoints");
    return out;
}

std::string hours(double seconds) {
    char text[64];
    std::snprintf(text, sizeof text, "%.3g core-hours", seconds / 3600);
    return text;
}
} // namespace

RunSize run_size(const study::Study& study, const study::Candidate& candidate) {
    const auto& scene = scene_of(study, candidate.scene);
    const auto input =
        load_scene(source_of(study.scene_file(scene), study::assignments_of(study, scene, candidate.values)));
    const auto geometry = build_geometry(input);
    const auto counts = estimate_particles(input, geometry);
    const auto estimates = estimate_run(input, geometry, counts.liquid, counts.solid);
    return {double(counts.liquid) + estimates.poured + double(counts.solid), estimates.steps,
        input.scene.domain.spacing, input.scene.domain.dimensions};
}

StudyPlan plan_of(const study::RunOptions& options, const MeasuredRun& measured, const std::vector<RunSize>& sizes) {
    StudyPlan plan;
    plan.runs = sizes.size();
    double sum = 0;
    for (const auto& size : sizes) {
        const double steps = size.steps / measured.size.steps, particles = size.particles / measured.size.particles;
        sum += measured.start_seconds + (measured.seconds - measured.start_seconds) * particles * steps;
        plan.bytes += measured.bytes_fixed;
        if (options.keep != study::Keep::nothing) plan.bytes += measured.bytes_by_step * steps;
        if (options.keep == study::Keep::everything) plan.bytes += measured.bytes_by_frame * particles;
    }
    plan.core_seconds = sum * options.ranks;
    plan.seconds = sum / double(std::min<std::size_t>(
                             std::size_t(study::lane_count(options)), std::max<std::size_t>(1, sizes.size())));
    return plan;
}

ExitCode plan_study(
    const std::filesystem::path& file, const std::filesystem::path& out, const std::vector<std::string>& overrides) {
    const auto whole = load_checked_study(file, overrides);
    const auto& study = whole.study;
    auto candidates = sweep_candidates(whole);
    std::set<std::string> keys;
    std::erase_if(candidates, [&](const study::Candidate& one) { return !keys.insert(one.key).second; });
    study::check_launcher(study);
    std::vector<RunSize> sizes;
    sizes.reserve(candidates.size());
    for (const auto& one : candidates) sizes.push_back(run_size(study, one));
    const auto& middle = candidates[candidates.size() / 2];
    const auto folder = study_folder(study.path, out) / "plan";
    const auto measured = measure(coarse_study(study, middle, sizes[candidates.size() / 2].spacing, folder), folder);
    const auto plan = plan_of(study.runs, measured, sizes);
    std::printf("one run of %.0f particles took %s, %s of it before its first step\n", measured.size.particles,
        format_duration(measured.seconds).c_str(), format_duration(measured.start_seconds).c_str());
    std::printf("runs        %zu\ncores       %s\ntime        %s on %d lanes of %d ranks\ndisk        %s\nmemory      "
                "%s a run\n",
        plan.runs, hours(plan.core_seconds).c_str(), format_duration(plan.seconds).c_str(),
        study::lane_count(study.runs), study.runs.ranks, format_bytes(std::uint64_t(plan.bytes)).c_str(),
        format_bytes(std::uint64_t(largest_run_memory(study, candidates))).c_str());
    return ExitCode::ok;
}

} // namespace treacle::app
