#include "app/identify/next.hpp"

#include "app/compare/experiments.hpp"
#include "app/identify/flow_curve_bands.hpp"
#include "app/identify/identified_liquids.hpp"
#include "base/options/options.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"
#include "identify/estimate/design.hpp"
#include "identify/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace treacle::app {

namespace {
constexpr int rate_points = 16;
constexpr double difference = 0.08; // of a parameter's range: far above the noise of runs, and near enough to be linear

// A study in which a candidate stands alone, at the coarsest spacing, compared with `masks`.
struct CandidateStudy {
    const identify::StudyFile& file;
    const identify::SetUp& set_up;
    std::filesystem::path folder;

    const identify::Experiment& like() const {
        const auto& all = file.experiments;
        const auto found =
            set_up.like.empty() ? all.begin() : std::ranges::find(all, set_up.like, &identify::Experiment::name);
        if (found == all.end())
            throw InputError({set_up.where, "there is no experiment " + set_up.like,
                "a candidate is like one that was filmed", "give the name of one under `experiments`"});
        if (found->kind == identify::ExperimentKind::contours) return *found;
        throw InputError(
            {set_up.where, "the experiment " + found->name + " is not compared by its masks frame by frame",
                "candidates are films", "name another with `like`"});
    }
    identify::StudyFile write(const std::filesystem::path& masks, const char* name) const {
        auto out = file;
        auto scene = file.scene_of(like());
        scene.file = file.study.scene_file(scene).string();
        scene.set.insert(scene.set.end(), set_up.set.begin(), set_up.set.end());
        scene.name = "candidate";
        auto experiment = like();
        experiment.name = experiment.scene = scene.name;
        experiment.masks = masks.string();
        if (!set_up.camera.empty()) experiment.camera = set_up.camera;
        if (std::filesystem::is_regular_file(file.beside(experiment.camera)))
            experiment.camera = file.beside(experiment.camera).string();
        if (set_up.from >= 0) experiment.from = set_up.from;
        if (set_up.to >= 0) experiment.to = set_up.to;
        out.study.scenes = {scene};
        out.experiments = {experiment};
        out.candidates.clear();
        out.search = {};
        out.temperature = {};
        for (auto& parameter : out.study.parameters)
            parameter.values.resize(std::min<std::size_t>(1, parameter.values.size()));
        std::filesystem::create_directories(folder);
        write_file_atomically(folder / name, effective(out));
        return load_checked_study(folder / name);
    }
};

// Runs of a candidate's study at points of the searched parameters; their folders. Throws SimulationError where one fails.
std::vector<std::filesystem::path> run_points(const identify::StudyFile& file,
    const std::vector<std::vector<double>>& points, const std::filesystem::path& folder, Log& log) {
    const StudyScenes scenes(file);
    study::StudyRuns runs(file.study, {folder, this_program(), {}}, log);
    std::vector<std::int64_t> numbers;
    for (const auto& point : points) {
        study::Point words;
        for (std::size_t k = 0; k < file.study.parameters.size(); ++k) {
            const auto& parameter = file.study.parameters[k];
            words.push_back(k < point.size() ? parameter.word(point[k]) : parameter.values.front());
        }
        numbers.push_back(runs.ask(study::candidate_of(file.study, file.study.scenes.front(), words, scenes.reader())));
    }
    if (runs.run(numbers) == study::StudyEnd::stopped) return {};
    std::vector<std::filesystem::path> out;
    for (const auto number : numbers) {
        const auto* outcome = runs.journal().outcome(number);
        if (!outcome || outcome->status != study::RunStatus::done)
            throw SimulationError({runs.run_folder(number).string(), "a run of the candidate failed",
                outcome ? outcome->reason : "", "its log.txt says more"});
        out.push_back(runs.folder_of(number));
    }
    return out;
}

// The answer, and it moved along each coordinate, into the range; how far.
std::vector<std::vector<double>> points_around(
    const identify::StudyFile& file, const std::vector<double>& answer, std::vector<double>& steps) {
    std::vector<std::vector<double>> out{answer};
    for (std::size_t k = 0; k < file.searched; ++k) {
        out.push_back(answer);
        steps.push_back(identify::move_along(file.study.parameters[k], difference, out.back()[k]));
    }
    return out;
}

// The masks of the candidate as the run at the answer would be filmed, at the times of the film that it is like.
std::filesystem::path film_candidate(const CandidateStudy& candidate, const std::vector<double>& answer, Log& log) {
    const auto masks = candidate.file.beside(candidate.like().masks);
    const auto study = candidate.write(masks, "filmed.yaml");
    const auto run = run_points(study, {answer}, candidate.folder / "filmed", log);
    if (run.empty()) return {};
    auto out = run.front() / "masks_candidate";
    for (const char* name : {"silhouettes.csv", "film.csv"}) {
        if (std::filesystem::is_regular_file(masks / name))
            std::filesystem::copy_file(masks / name, out / name, std::filesystem::copy_options::overwrite_existing);
    }
    return out;
}

// Information that a candidate gives; nothing when stopped.
std::optional<Eigen::MatrixXd> information_of(
    const CandidateStudy& candidate, const identify::Identification& found, double variance, Log& log) {
    const auto masks = film_candidate(candidate, found.values, log);
    if (masks.empty()) return {};
    const auto study = candidate.write(masks, "study.yaml");
    std::vector<double> steps;
    const auto folders =
        run_points(study, points_around(candidate.file, found.values, steps), candidate.folder / "moved", log);
    if (folders.empty()) return {};
    std::vector<identify::RunResiduals> runs;
    runs.reserve(folders.size());
    for (const auto& folder : folders) runs.push_back(identify::read_residuals(folder, "candidate"));
    const auto base = runs.front();
    runs.erase(runs.begin());
    return identify::information_of_runs(base, runs, steps, experiment_priors(study).front(), variance);
}

struct Row {
    std::string name;
    double half_width = 0; // of ln eta
};

void say(const std::vector<Row>& rows, double now, const NextRequest& request, const std::filesystem::path& folder,
    Log& log) {
    std::string csv = "candidate,half-width of the 90 % band,share of now\n";
    char text[160];
    std::snprintf(text, sizeof text, "half the width of the flow curve's 90 %% band over %.3g to %.3g 1/s: now %.1f %%",
        request.low, request.high, 100 * now);
    log.line(text);
    for (const auto& row : rows) {
        std::snprintf(text, sizeof text, "  with %-24s %6.1f %%   %.2f of now", row.name.c_str(), 100 * row.half_width,
            row.half_width / now);
        log.line(text);
        csv += row.name + "," + format_number(row.half_width) + "," + format_number(row.half_width / now) + "\n";
    }
    write_file_atomically(folder / "next.csv", csv);
    log.line("film next: " + rows.front().name + "; the table: " + (folder / "next.csv").string());
}
} // namespace

ExitCode propose_next(const NextRequest& request) {
    if (const auto asked = load_checked_study(request.study, request.overrides); asked.candidates.empty()) {
        throw InputError({asked.study.path.string(), "has no candidates", "there is nothing to choose from",
            "list set-ups that you could film: candidates: [{name: low, set: [\"liquids.lotion.shapes.0.box.max=[2.5 "
            "cm, 5 cm]\"]}]"});
    }
    const auto found = identified_study(request);
    const auto& file = found.file;
    const auto liquids = searched_liquids(file);
    if (liquids.empty())
        throw InputError({file.study.path.string(), "searches no key of a liquid",
            "candidates are ranked by its flow curve", "`treacle next` is for viscosities and rheologies"});
    if (found.answer.end == study::StudyEnd::stopped) return ExitCode::stopped;
    if (!found.answer.estimate) return ExitCode::simulation_failed;
    std::vector<double> rates;
    rates.reserve(rate_points);
    for (int i = 0; i < rate_points; ++i)
        rates.push_back(request.low * std::pow(request.high / request.low, double(i) / (rate_points - 1)));
    const auto slopes = flow_curve_slopes(file, found.answer.values, liquids.front(), rates);
    std::vector<identify::ExperimentKind> kinds;
    for (const auto& one : file.experiments) kinds.push_back(one.kind);
    // A film to come is burdened by resolution, numerical noise and measured values as those so far are.
    const auto& told_by_films = found.answer.estimate->covariance;
    const double burden = told_by_films.ldlt().solve(found.answer.covariance).trace() / double(file.searched);
    const double variance = std::max(1.0, burden) * identify::segment_variance(*found.answer.estimate, kinds);
    const double now = identify::band_half_width(found.answer.covariance, slopes);
    Log log(LogOutput::enabled);
    for (const auto& line : identify::trade_lines(file, found.answer)) log.line(line);
    std::vector<Row> rows;
    for (const auto& set_up : file.candidates) {
        const auto told =
            information_of({file, set_up, found.folder / "next" / set_up.name}, found.answer, variance, log);
        if (!told) return ExitCode::stopped;
        rows.push_back({set_up.name,
            identify::band_half_width(identify::covariance_after(found.answer.covariance, *told), slopes)});
    }
    std::ranges::stable_sort(rows, {}, &Row::half_width);
    say(rows, now, request, found.folder, log);
    return ExitCode::ok;
}

} // namespace treacle::app
