#include "app/compare/experiments.hpp"

#include "app/compare/compare_films.hpp"
#include "app/compare/compare_occupancy.hpp"
#include "app/compare/compare_series.hpp"
#include "app/compare/compare_sheets.hpp"
#include "app/compare/run_shear_rates.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "base/text/units.hpp"
#include "io/manifest.hpp"

#include <algorithm>

namespace treacle::app {

namespace {
using identify::Experiment;
using identify::ExperimentKind;
using identify::StudyFile;

// In order, those of different experiments that are as good as the same once.
std::vector<std::string> numbers_apart(std::vector<double> times) {
    constexpr double same = 1e-6; // [s]
    std::ranges::sort(times);
    std::vector<std::string> out;
    double last = -1;
    for (const double time : times) {
        if (time < last + same) continue;
        out.push_back(format_number(time));
        last = time;
    }
    return out;
}

Input input_of(const StudyFile& file, const study::StudyScene& scene) {
    return load_scene({file.study.scene_file(scene), scene.set, {}, {}, {}});
}

// Goes on with the comparison that has begun, where one has.
void compare_with_film(const Comm& comm, const StudyFile& file, const Experiment& experiment, const RunView& run,
    const std::filesystem::path& folder, std::list<FilmComparison>* begun) {
    if (begun) {
        const auto one = std::ranges::find_if(
            *begun, [&](const FilmComparison& other) { return &other.experiment() == &experiment; });
        if (one != begun->end()) return one->complete(run);
    }
    FilmComparison(comm, file, experiment, folder).complete(run);
}
} // namespace

std::vector<const Experiment*> experiments_of(const StudyFile& file, const study::StudyScene& scene) {
    std::vector<const Experiment*> out;
    for (const auto& one : file.experiments) {
        if (&file.scene_of(one) == &scene) out.push_back(&one);
    }
    return out;
}
void check_end(const std::string& where, const std::string& name, double last, double end) {
    if (last <= end * (1 + 1e-9)) return;
    throw InputError({where, name + " is compared up to " + format_number(last) + " s",
        "the scene ends at " + format_number(end) + " s", "give `to`, or a longer time.end"});
}

identify::Priors experiment_priors(const StudyFile& file) {
    identify::Priors out;
    for (const auto& experiment : file.experiments) {
        if (experiment.kind == ExperimentKind::piv) {
            out.push_back(identify::sheet_information(experiment.plus_minus));
            continue;
        }
        if (experiment.kind == ExperimentKind::series) {
            out.push_back(identify::series_information(experiment.plus_minus, experiment.series));
            continue;
        }
        const auto camera = experiment_camera(file, experiment, input_of(file, file.scene_of(experiment)));
        out.push_back(identify::information_of(experiment.plus_minus, camera.pose_covariance, camera.focal_deviation));
    }
    return out;
}

void compare_with_experiments(const Comm& comm, const StudyFile& file, const study::StudyScene& scene,
    const std::filesystem::path& folder, std::list<FilmComparison>* begun) {
    const auto experiments = experiments_of(file, scene);
    if (experiments.empty()) return;
    const auto run = open_run(comm, folder / "run");
    for (const auto* experiment : experiments) {
        if (experiment->kind == ExperimentKind::series) {
            comm.guard_root([&] { compare_with_series(file, *experiment, run.input, folder); });
            continue;
        }
        require_frames(run);
        if (experiment->kind == ExperimentKind::piv) {
            compare_with_sheet(comm, file, *experiment, run, folder);
        } else if (experiment->kind == ExperimentKind::occupancy) {
            compare_occupancy(comm, file, *experiment, run, folder);
        } else {
            compare_with_film(comm, file, *experiment, run, folder, begun);
        }
    }
    if (run.frames.empty()) return;
    const auto rates = run_shear_rates(comm, run);
    comm.guard_root([&] {
        identify::write_shear_rates(folder, rates.all);
        identify::write_frame_shear_rates(folder, rates.frames);
    });
}

ObservationNeeds scene_needs(const StudyFile& file, const study::StudyScene& scene) {
    ObservationNeeds out;
    const auto experiments = experiments_of(file, scene);
    if (experiments.empty()) return out;
    const auto input = input_of(file, scene);
    std::string content;
    double interval = 0; // [s] the least between observations of one experiment: those of others may be a moment apart
    for (const auto* experiment : experiments) {
        const auto one = experiment->kind == ExperimentKind::piv      ? sheet_needs(file, *experiment, input)
                         : experiment->kind == ExperimentKind::series ? series_needs(file, *experiment, input)
                                                                      : film_needs(file, *experiment, input);
        content += one.content;
        out.assignments.insert(out.assignments.end(), one.assignments.begin(), one.assignments.end());
        out.times.insert(out.times.end(), one.times.begin(), one.times.end());
        const double own = least_interval(one.times, std::identity{});
        if (own > 0) interval = interval > 0 ? std::min(interval, own) : own;
    }
    out.content = io::text_hash(content);
    if (out.times.empty()) return out; // series alone: no frame is read
    // Frames at the observations' own times: surfaces that are moved there by their velocity alone miss what the flow gains in between.
    out.assignments.push_back({"output.interval=0", "the times of what is observed"});
    // Rungs correct for what falls with the spacing: steps too, which frames and not the flow may have limited, at all rungs by the same.
    const bool follows = input.scene.time.rule == scene::StepRule::cfl && input.scene.time.step == 0;
    if (follows && file.has_rungs()) {
        const auto coarsest = read_quantity(file.search.rungs.front(), unit::length);
        if (const auto* spacing = std::get_if<double>(&coarsest)) out.step_per_spacing = 0.5 * interval / *spacing;
    }
    out.assignments.push_back(
        {"output.times=[" + join(numbers_apart(out.times), ", ") + "]", "the times of what is observed"});
    return out;
}

namespace {

std::string describe_masks(const StudyFile& file, const Experiment& experiment) {
    const auto folder = file.beside(experiment.masks);
    return folder.string() + ": " + std::to_string(identify::observed_frames(experiment, folder).size()) + " masks";
}

} // namespace

std::string describe_observations(const StudyFile& file, const Experiment& experiment) {
    if (has_masks(experiment.kind)) return describe_masks(file, experiment);
    const auto input = input_of(file, file.scene_of(experiment));
    if (experiment.kind == ExperimentKind::series)
        return file.beside(experiment.series.file).string() + ": " +
               std::to_string(observed_series(file, experiment, input).size()) + " values";
    const auto sheet = observed_sheet(file, experiment, input);
    const auto& counts = sheet.counts;
    std::string out = std::to_string(sheet.fields.size()) + " fields, " + std::to_string(counts.vectors) +
                      " vectors, " + std::to_string(counts.kept()) + " compared";
    const auto add = [&](std::size_t count, const char* what) {
        if (count > 0) out += ", " + std::to_string(count) + " " + what;
    };
    add(counts.missing, "not measured");
    add(counts.outliers, "outliers dropped");
    add(counts.masked, "masked");
    add(counts.touching, "at the ball dropped");
    return out;
}

} // namespace treacle::app
