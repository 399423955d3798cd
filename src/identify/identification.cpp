#include "identify/identification.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "search/bracketing.hpp"
#include "search/cma_es.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace treacle::identify {

namespace {
constexpr double ninety_percent = 1.6449; // standard deviations to either side
constexpr double none = std::numeric_limits<double>::quiet_NaN();

// The search's coordinate of a parameter's value, and back.
double coordinate(const study::Parameter& parameter, double value) { return parameter.scale == study::Scale::log ? std::log(value) : value; }
double value_of(const study::Parameter& parameter, double x) {
    const double value = parameter.scale == study::Scale::log ? std::exp(x) : x;
    return std::clamp(value, parameter.lower, parameter.upper);
}

std::vector<search::Axis> axes_of(const StudyFile& file) {
    std::vector<search::Axis> out;
    for (const auto& parameter : file.study.parameters) {
        if (!parameter.has_range()) {
            throw InputError({parameter.where, parameter.name + " has no range", "`treacle identify` searches within ranges", "give it a `range`"});
        }
        search::Axis axis;
        axis.lower = coordinate(parameter, parameter.lower);
        axis.upper = coordinate(parameter, parameter.upper);
        const auto start = parameter.number(parameter.start);
        axis.start = start ? coordinate(parameter, *start) : 0.5 * (axis.lower + axis.upper);
        axis.step = (axis.upper - axis.lower) / 4;
        const bool log = parameter.scale == study::Scale::log;
        axis.tolerance = file.search.tolerance * (log ? 1 : std::max(std::abs(axis.start), axis.step));
        out.push_back(axis);
    }
    if (out.empty()) {
        throw InputError({file.study.path.string(), "has no parameters", "there would be nothing to identify",
                          "add one, for instance {key: liquids.syrup.viscosity, range: [0.1 Pa.s, 100 Pa.s], scale: log}"});
    }
    return out;
}

std::unique_ptr<search::Search> search_of(const StudyFile& file) {
    const auto axes = axes_of(file);
    search::Limits limits;
    limits.evaluations = file.search.evaluations;
    const auto seed = std::uint64_t(file.search.seed);
    if (file.search.method == Method::bracketing) {
        if (axes.size() == 1) return std::make_unique<search::Bracketing>(axes.front(), limits);
        throw InputError({file.study.path.string(), "search.method = bracketing, for " + std::to_string(axes.size()) + " parameters", "it brackets one",
                          "write search: cma_es"});
    }
    auto options = file.search.method == Method::dissertation ? search::CmaOptions::dissertation(seed) : search::CmaOptions{};
    options.seed = seed;
    options.limits.evaluations = limits.evaluations;
    return std::make_unique<search::CmaEs>(axes, options);
}

// Runs candidates and keeps what came of them.
class Trials {
public:
    Trials(const StudyFile& file, const Priors& priors, study::StudyRuns& runs, const study::SceneReader& read_scene, Identification& out)
        : file_(file), priors_(priors), runs_(runs), read_scene_(read_scene), out_(out) {}

    // False when asked to stop.
    bool run(const std::vector<search::Point>& points) {
        std::vector<std::int64_t> numbers;
        std::vector<Trial> fresh;
        for (const auto& point : points) {
            auto& trial = fresh.emplace_back();
            study::Point words;
            for (std::size_t k = 0; k < point.size(); ++k) {
                const auto& parameter = file_.study.parameters[k];
                trial.values.push_back(value_of(parameter, point[k]));
                words.push_back(parameter.word(trial.values.back()));
            }
            for (const auto& scene : file_.study.scenes) {
                trial.runs.push_back(runs_.ask(study::candidate_of(file_.study, scene, words, read_scene_)));
                numbers.push_back(trial.runs.back());
            }
        }
        if (runs_.run(numbers) == study::StudyEnd::stopped) return false;
        for (std::size_t i = 0; i < points.size(); ++i) {
            evaluate(fresh[i], points[i]);
            out_.trials.push_back(fresh[i]);
        }
        return true;
    }
    const std::vector<EvaluatedRun>& good() const { return good_; }

private:
    void evaluate(Trial& trial, const search::Point& point) {
        trial.objective = trial.mismatch = none;
        EvaluatedRun run;
        run.point = Eigen::Map<const Eigen::VectorXd>(point.data(), Eigen::Index(point.size()));
        for (const auto& experiment : file_.experiments) {
            const auto scene = std::size_t(&file_.scene_of(experiment) - file_.study.scenes.data());
            const auto number = trial.runs[scene];
            const auto* outcome = runs_.journal().outcome(number);
            if (!outcome || outcome->status != study::RunStatus::done) return;
            run.experiments.push_back(read_residuals(outcome->folder.empty() ? runs_.run_folder(number) : std::filesystem::path(outcome->folder), experiment.name));
        }
        trial.objective = contour_objective(run, priors_);
        trial.mismatch = 0;
        for (const auto& one : run.experiments) trial.mismatch += one.mismatch / double(run.experiments.size());
        const bool known = std::ranges::any_of(good_, [&](const EvaluatedRun& other) { return other.point == run.point; });
        if (!known) good_.push_back(std::move(run));
    }

    const StudyFile& file_;
    const Priors& priors_;
    study::StudyRuns& runs_;
    const study::SceneReader& read_scene_;
    Identification& out_;
    std::vector<EvaluatedRun> good_;
};

// A run at the estimate and one to either side of it, a few standard deviations away: the local model then says what the
// runs near the answer say. Only for what the search has not done.
std::vector<search::Point> runs_around(const Estimate& estimate, const std::vector<EvaluatedRun>& good, const std::vector<search::Axis>& axes) {
    constexpr double reach = 0.12, near = 0.03; // of the logarithm of a viscosity
    std::vector<search::Point> out;
    const auto p = std::size_t(estimate.point.size());
    for (std::size_t k = 0; k < p; ++k) {
        for (const double side : {-reach, 0.0, reach}) {
            search::Point point(estimate.point.data(), estimate.point.data() + p);
            point[k] = std::clamp(point[k] + side, axes[k].lower, axes[k].upper);
            const bool there = std::ranges::any_of(good, [&](const EvaluatedRun& run) {
                return (run.point - Eigen::Map<const Eigen::VectorXd>(point.data(), Eigen::Index(p))).cwiseAbs().maxCoeff() < (side == 0 ? near / 3 : near);
            });
            if (!there && std::ranges::find(out, point) == out.end()) out.push_back(point);
        }
    }
    return out;
}

void say_answer(const StudyFile& file, Identification& out) {
    const auto& estimate = *out.estimate;
    for (std::size_t k = 0; k < file.study.parameters.size(); ++k) {
        const auto& parameter = file.study.parameters[k];
        const double x = estimate.point[Eigen::Index(k)], deviation = std::sqrt(estimate.covariance(Eigen::Index(k), Eigen::Index(k)));
        const bool log = parameter.scale == study::Scale::log;
        const auto at = [&](double y) { return log ? std::exp(y) : y; };
        out.values.push_back(at(x));
        out.low.push_back(at(x - ninety_percent * deviation));
        out.high.push_back(at(x + ninety_percent * deviation));
    }
}
} // namespace

ViewInformation information_of(const ViewUncertainty& uncertainty, const std::optional<Eigen::Matrix<double, 6, 6>>& pose, double focal_deviation) {
    const auto of = [](double deviation) { return 1 / std::max(1e-24, deviation * deviation); };
    ViewInformation out = ViewInformation::Zero();
    out(view_time, view_time) = of(uncertainty.time_zero);
    out(view_contour, view_contour) = of(uncertainty.contour);
    out(view_focal, view_focal) = of(focal_deviation > 0 ? focal_deviation : uncertainty.focal);
    if (pose) {
        out.block<6, 6>(view_turn, view_turn) = (*pose + 1e-24 * Eigen::Matrix<double, 6, 6>::Identity()).inverse();
    } else {
        for (int k = 0; k < 3; ++k) {
            out(view_turn + k, view_turn + k) = of(uncertainty.turn);
            out(view_place + k, view_place + k) = of(uncertainty.place);
        }
    }
    return out;
}

Identification identify(const StudyFile& file, const Priors& priors, study::StudyRuns& runs, const study::SceneReader& read_scene, Log& log) {
    Identification out;
    auto search = search_of(file);
    Trials trials(file, priors, runs, read_scene, out);
    const auto tell = [&](std::size_t from) {
        for (std::size_t i = from; i < out.trials.size(); ++i) {
            const auto& trial = out.trials[i];
            std::string line = "trial " + std::to_string(i + 1);
            for (std::size_t k = 0; k < trial.values.size(); ++k) line += "  " + file.study.parameters[k].name + " " + file.study.parameters[k].word(trial.values[k]);
            log.line(line + (std::isnan(trial.objective) ? "  failed" : "  objective " + format_number(trial.objective)));
        }
    };
    while (!search->stopped()) {
        const auto before = out.trials.size();
        if (!trials.run(search->ask())) {
            out.end = study::StudyEnd::stopped;
            return out;
        }
        tell(before);
        std::vector<search::Value> values;
        for (std::size_t i = before; i < out.trials.size(); ++i) {
            values.push_back(std::isnan(out.trials[i].objective) ? search::Value::failed() : search::Value::measured(out.trials[i].objective));
        }
        search->tell(values);
    }
    out.stop = search->stopped()->text;
    try {
        for (int round = 0; round < 2; ++round) {
            const auto first = estimate(trials.good(), priors);
            const auto more = runs_around(first, trials.good(), search->axes());
            if (more.empty()) break;
            const auto before = out.trials.size();
            if (!trials.run(more)) {
                out.end = study::StudyEnd::stopped;
                return out;
            }
            tell(before);
        }
        out.estimate = estimate(trials.good(), priors);
        say_answer(file, out);
    } catch (const InputError& error) {
        out.problem = error.what();
    }
    return out;
}

} // namespace treacle::identify
