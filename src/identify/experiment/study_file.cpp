#include "identify/experiment/study_file.hpp"

#include "base/options/document.hpp"
#include "base/options/options.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

void StudyFile::declare(Declaration& d) {
    study.declare(d);
    d.list("experiments", experiments, "Films that the runs are compared with, for `treacle identify`.");
    d.list("candidates", candidates, "Experiments that could be filmed next, among which `treacle next` chooses.");
    d.block("search", search, "How `treacle identify` looks for the parameters.", "method");
    d.block("temperature", temperature, "Temperature of the liquid during the experiments.");
    if (!d.parsing()) return;
    searched = study.parameters.size();
    if (!experiments.empty()) add_measured_and_rungs(d);
    const bool films =
        std::ranges::all_of(experiments, [](const Experiment& one) { return one.kind == ExperimentKind::contours; });
    d.check(films || search.objective == Objective::displacements, "search",
        {"must have objective: displacements", "the mismatch (6.9) is that of masks, frame by frame",
            "leave the objective out"});
    for (std::size_t i = 0; i < experiments.size(); ++i) {
        const auto& one = experiments[i];
        const bool known = one.scene.empty() ||
                           std::ranges::find(study.scenes, one.scene, &study::StudyScene::name) != study.scenes.end();
        d.check(known, "experiments",
            {"must name scenes of the study", one.where + ": there is no scene " + one.scene,
                "give the name of one under `scenes`"});
        const auto original = std::ranges::find(
            experiments.begin(), experiments.begin() + std::ptrdiff_t(i), one.repeats, &Experiment::name);
        const bool repeats_one = original != experiments.begin() + std::ptrdiff_t(i) && original->repeats.empty() &&
                                 original->scene == one.scene && original->kind == one.kind;
        d.check(one.repeats.empty() || repeats_one, "experiments",
            {"must repeat an experiment above of the same scene and kind",
                one.where + ": repeats = " + one.repeats + " is none, or repeats another one itself",
                "give the name of the set-up's first clip"});
        for (std::size_t k = 0; k < i; ++k) {
            d.check(experiments[k].name != one.name, "experiments",
                {"must have names that differ",
                    one.where + ": " + one.name + " stands at " + experiments[k].where + " too",
                    "give one of them another name"});
        }
    }
}

double move_along(const study::Parameter& parameter, double fraction, double& value) {
    const bool log = parameter.scale == study::Scale::log;
    const auto coordinate = [&](double one) { return log ? std::log(one) : one; };
    const double x = coordinate(value), upper = coordinate(parameter.upper),
                 step = fraction * (upper - coordinate(parameter.lower)) *
                        (x + fraction * (upper - coordinate(parameter.lower)) <= upper ? 1 : -1);
    value = log ? std::exp(x + step) : x + step;
    return step;
}

// Runs differ in the measured values and the spacing as in the parameters: the journal and the requests have them as
// such.
void StudyFile::add_measured_and_rungs(Declaration& d) {
    for (const auto& one : study.measured) {
        study::Parameter parameter;
        parameter.name = one.name;
        parameter.key = one.key;
        parameter.where = one.where;
        parameter.values = {one.value};
        parameter.settle();
        study.parameters.push_back(parameter);
        const auto deviation = study::read_number_and_unit(one.plus_minus);
        deviations.push_back(deviation ? deviation->value : 0);
        exponents.push_back(one.exponent);
    }
    measured = study.measured.size();
    study.measured.clear();
    if (search.rungs.empty()) return;
    study::Parameter spacing;
    spacing.name = "spacing";
    spacing.key = "domain.spacing";
    spacing.where = study.path.string() + ": search.rungs";
    spacing.values = search.rungs;
    spacing.settle();
    search.rungs = spacing.values; // in the unit of the first
    bool falls = spacing.numeric;
    for (std::size_t i = 1; falls && i < search.rungs.size(); ++i) {
        const auto coarse = spacing.number(search.rungs[i - 1]), fine = spacing.number(search.rungs[i]);
        falls = coarse && fine && *fine < *coarse;
    }
    d.check(falls, "search",
        {"must have spacings as rungs, the coarsest first", "they are " + join(search.rungs, ", "),
            "write for instance rungs: [8 mm, 5.6 mm, 4 mm]"});
    for (const auto& parameter : study.parameters) {
        d.check(parameter.key != spacing.key, "search",
            {"must not have rungs beside a parameter of the spacing", parameter.where + " sets it too",
                "leave one of them out"});
    }
    study.parameters.push_back(spacing);
}

namespace {
// The coarsest of three rungs or more, and the first that is finer enough: the scatter of rungs that are near each other is multiplied.
void take_two(study::Parameter& spacing) {
    constexpr double ratio = 1.6;
    if (spacing.values.size() < 3) return;
    std::size_t finer = 1;
    while (finer + 1 < spacing.values.size() &&
           *spacing.number(spacing.values[finer]) * ratio > *spacing.number(spacing.values.front()))
        ++finer;
    spacing.values = {spacing.values.front(), spacing.values[finer]};
}
} // namespace

void StudyFile::make_quick() {
    constexpr int evaluations = 10;
    constexpr double tolerance = 0.02;
    if (has_rungs()) {
        take_two(study.parameters.back());
        search.rungs = study.parameters.back().values;
    }
    search.noise_runs = std::min(search.noise_runs, 1);
    search.evaluations = std::min(search.evaluations, evaluations);
    search.tolerance = std::max(search.tolerance, tolerance);
    std::ranges::fill(deviations, 0.0);
}

const study::StudyScene& StudyFile::scene_of(const Experiment& experiment) const {
    if (experiment.scene.empty()) return study.scenes.front();
    return *std::ranges::find(study.scenes, experiment.scene, &study::StudyScene::name);
}

std::filesystem::path StudyFile::beside(const std::string& name) const {
    const std::filesystem::path path = name;
    return (path.is_absolute() ? path : study.path.parent_path() / path).lexically_normal();
}

namespace {
// Does some work on options; its errors then refer to the manual of studies in the place of that of scenes.
template <class Work>
auto with_study_manual(const Work& work) {
    try {
        return work();
    } catch (const InputError& error) {
        auto problems = error.diagnostics();
        const std::string manual = "`treacle schema", own = manual + " --study";
        for (auto& problem : problems) {
            auto& cure = problem.cure;
            for (auto at = cure.find(manual); at != std::string::npos; at = cure.find(manual, at + own.size())) {
                if (cure.compare(at, own.size(), own) != 0) cure.replace(at, manual.size(), own);
            }
        }
        throw InputError(problems);
    }
}
} // namespace

StudyFile load_study_file(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
    auto document = Document::load(path);
    for (const auto& assignment : overrides) document.set(assignment);
    StudyFile out;
    out.study.overrides = overrides;
    out.study.path = std::filesystem::absolute(path).lexically_normal();
    with_study_manual([&] { parse(document, out); });
    return out;
}

std::string study_manual(const std::string& key) {
    return with_study_manual([&] { return manual(StudyFile{}, key); });
}
std::string study_schema() { return json_schema(StudyFile{}); }

} // namespace treacle::identify
