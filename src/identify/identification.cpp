#include "identify/identification.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "identify/profile.hpp"
#include "search/bracketing.hpp"
#include "search/cma_es.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

namespace treacle::identify {

namespace {
constexpr double none = std::numeric_limits<double>::quiet_NaN();

// The search's coordinate of a parameter's value, and back.
double coordinate(const study::Parameter& parameter, double value) { return parameter.scale == study::Scale::log ? std::log(value) : value; }
double value_of(const study::Parameter& parameter, double x) {
    const double value = parameter.scale == study::Scale::log ? std::exp(x) : x;
    return std::clamp(value, parameter.lower, parameter.upper);
}

std::vector<search::Axis> axes_of(const StudyFile& file) {
    std::vector<search::Axis> out;
    for (std::size_t k = 0; k < file.searched; ++k) {
        const auto& parameter = file.study.parameters[k];
        if (!parameter.has_range()) {
            throw InputError({parameter.where, parameter.name + " has no range", "`treacle identify` searches within ranges", "give it a `range`"});
        }
        if (parameter.key.starts_with("liquids.") && parameter.key.ends_with(".density")) {
            throw InputError({parameter.where, parameter.name + " cannot be searched", "silhouettes know the ratio of viscosity and density only: a flow "
                              "twice as dense and twice as viscous looks the same", "weigh a measured volume of the liquid, and give the density under `measured` with its plus_minus"});
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

// A change of a run against those of the search: of the spacing, or of a measured value.
struct Variation {
    std::string purpose = "search";
    std::size_t parameter = std::numeric_limits<std::size_t>::max(); // of the study; none: as in the search
    double value = 0;                                                // in its unit
};

// Runs candidates and keeps what came of them.
class Trials {
public:
    Trials(const StudyFile& file, const Priors& priors, study::StudyRuns& runs, const study::SceneReader& read_scene, Log& log, Identification& out)
        : file_(file), priors_(priors), runs_(runs), read_scene_(read_scene), log_(log), out_(out) {}

    // Of each point and its variation: nothing where a run failed. Throws Stopped when asked to stop.
    struct Stopped {};
    std::vector<std::optional<EvaluatedRun>> run(const std::vector<std::pair<search::Point, Variation>>& wanted) {
        std::vector<std::int64_t> numbers;
        std::vector<Trial> fresh;
        for (const auto& [point, variation] : wanted) {
            auto& trial = fresh.emplace_back();
            trial.purpose = variation.purpose;
            study::Point words;
            for (std::size_t k = 0; k < file_.study.parameters.size(); ++k) {
                const auto& parameter = file_.study.parameters[k];
                const double usual = k < point.size() ? value_of(parameter, point[k]) : *parameter.number(parameter.values.front());
                trial.values.push_back(k == variation.parameter ? variation.value : usual);
                words.push_back(parameter.word(trial.values.back()));
            }
            for (const auto& scene : file_.study.scenes) {
                trial.runs.push_back(runs_.ask(study::candidate_of(file_.study, scene, words, read_scene_)));
                numbers.push_back(trial.runs.back());
            }
        }
        if (runs_.run(numbers) == study::StudyEnd::stopped) throw Stopped{};
        std::vector<std::optional<EvaluatedRun>> out;
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            out.push_back(evaluate(fresh[i], wanted[i].first));
            tell(fresh[i]);
            out_.trials.push_back(fresh[i]);
            const auto& [point, variation] = wanted[i];
            const bool usual = variation.parameter == Variation{}.parameter;
            const bool known = out.back() && std::ranges::any_of(good_, [&](const EvaluatedRun& other) { return other.point == out.back()->point; });
            if (usual && out.back() && !known) good_.push_back(*out.back());
        }
        return out;
    }
    // Of the search's spacing and the measured values as they are.
    const std::vector<EvaluatedRun>& good() const { return good_; }

private:
    std::optional<EvaluatedRun> evaluate(Trial& trial, const search::Point& point) const {
        trial.objective = none;
        EvaluatedRun run;
        run.point = Eigen::Map<const Eigen::VectorXd>(point.data(), Eigen::Index(point.size()));
        for (const auto& experiment : file_.experiments) {
            const auto scene = std::size_t(&file_.scene_of(experiment) - file_.study.scenes.data());
            const auto number = trial.runs[scene];
            const auto* outcome = runs_.journal().outcome(number);
            if (!outcome || outcome->status != study::RunStatus::done) return {};
            run.experiments.push_back(read_residuals(outcome->folder.empty() ? runs_.run_folder(number) : std::filesystem::path(outcome->folder), experiment.name, experiment.kind));
        }
        trial.objective = residual_objective(run, priors_);
        for (const auto& one : run.experiments) trial.mismatches.push_back(one.mismatch);
        return run;
    }
    void tell(const Trial& trial) const {
        std::string line = "trial " + std::to_string(out_.trials.size() + 1) + " (" + trial.purpose + ")";
        for (std::size_t k = 0; k < trial.values.size(); ++k) line += "  " + file_.study.parameters[k].name + " " + short_word(file_.study.parameters[k], trial.values[k]);
        log_.line(line + (std::isnan(trial.objective) ? "  failed" : "  objective " + short_number(trial.objective)));
    }
    static std::string short_number(double value) {
        char text[32];
        std::snprintf(text, sizeof text, "%.4g", value);
        return text;
    }
    static std::string short_word(const study::Parameter& parameter, double value) {
        return short_number(value) + (parameter.unit.empty() ? "" : " " + parameter.unit);
    }

    const StudyFile& file_;
    const Priors& priors_;
    study::StudyRuns& runs_;
    const study::SceneReader& read_scene_;
    Log& log_;
    Identification& out_;
    std::vector<EvaluatedRun> good_;
};

// A run at the estimate and one to either side of it, a few standard deviations away: the local model then says what the
// runs near the answer say. Only for what the search has not done.
std::vector<std::pair<search::Point, Variation>> runs_around(const Estimate& estimate, const std::vector<EvaluatedRun>& good, const std::vector<search::Axis>& axes) {
    constexpr double reach = 0.12, near = 0.03; // of the logarithm of a viscosity
    std::vector<std::pair<search::Point, Variation>> out;
    const auto p = std::size_t(estimate.point.size());
    for (std::size_t k = 0; k < p; ++k) {
        for (const double side : {-reach, 0.0, reach}) {
            search::Point point(estimate.point.data(), estimate.point.data() + p);
            point[k] = std::clamp(point[k] + side, axes[k].lower, axes[k].upper);
            const bool there = std::ranges::any_of(good, [&](const EvaluatedRun& run) {
                return (run.point - Eigen::Map<const Eigen::VectorXd>(point.data(), Eigen::Index(p))).cwiseAbs().maxCoeff() < (side == 0 ? near / 3 : near);
            });
            const bool listed = std::ranges::any_of(out, [&](const auto& one) { return one.first == point; });
            if (!there && !listed) out.push_back({point, {"around the answer"}});
        }
    }
    return out;
}

double information(double deviation) { return 1 / std::max(1e-24, deviation * deviation); }

search::Point point_of(const Eigen::VectorXd& vector) { return {vector.data(), vector.data() + vector.size()}; }

// The answer at each finer rung: a run there, and how displacements change with the parameters from the search's rung.
void climb_rungs(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    const auto spacing = file.searched + file.measured;
    const auto& parameter = file.study.parameters[spacing];
    auto point = out.estimate->point;
    const auto note = [&](const std::string& word) {
        RungAnswer answer{word, {}};
        for (std::size_t k = 0; k < file.searched; ++k) answer.values.push_back(value_of(file.study.parameters[k], point[Eigen::Index(k)]));
        out.rungs.push_back(answer);
    };
    std::vector<std::vector<search::Rung>> rungs(file.searched);
    const auto keep = [&](double width) {
        for (std::size_t k = 0; k < file.searched; ++k) rungs[k].push_back({width, point[Eigen::Index(k)]});
    };
    note(parameter.values.front());
    keep(*parameter.number(parameter.values.front()));
    for (std::size_t i = 1; i < parameter.values.size(); ++i) {
        const double width = *parameter.number(parameter.values[i]);
        const auto run = trials.run({{point_of(point), {"rung " + parameter.values[i], spacing, width}}}).front();
        if (!run) continue; // its failure stands in the table; the others say what they can
        point = estimate(trials.good(), priors, &*run).point;
        note(parameter.values[i]);
        keep(width);
    }
    if (rungs.front().size() < 2) return;
    for (std::size_t k = 0; k < file.searched; ++k) {
        auto& parts = out.estimate->parts[k];
        const auto one = search::extrapolate(rungs[k], {std::sqrt(parts.noise), std::max(1, file.search.noise_runs)});
        out.corrections.push_back(one);
        parts.noise = one.noise * one.noise;
        parts.resolution = one.deviation * one.deviation - parts.noise;
    }
}

// Scatter of the answer over runs whose spacing, and with it the place of the cells in the flow, is a little another.
void measure_noise(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    constexpr std::array factors{0.985, 1.015, 0.97, 1.03, 0.955, 1.045, 0.94, 1.06};
    const auto spacing = file.searched + file.measured;
    const auto& parameter = file.study.parameters[spacing];
    const double width = *parameter.number(parameter.values.front());
    std::vector<std::pair<search::Point, Variation>> wanted;
    for (int i = 0; i < file.search.noise_runs; ++i) wanted.push_back({point_of(out.estimate->point), {"noise", spacing, width * factors[std::size_t(i)]}});
    std::vector<Eigen::VectorXd> answers{out.estimate->point};
    for (const auto& run : trials.run(wanted)) {
        if (run) answers.push_back(estimate(trials.good(), priors, &*run).point);
    }
    if (answers.size() < 2) return;
    for (std::size_t k = 0; k < file.searched; ++k) {
        double mean = 0, square = 0;
        for (const auto& one : answers) mean += one[Eigen::Index(k)] / double(answers.size());
        for (const auto& one : answers) square += std::pow(one[Eigen::Index(k)] - mean, 2);
        out.estimate->parts[k].noise = square / double(answers.size() - 1);
    }
}

// How far a measured value is changed to see what it does: far enough that the change stands out of the numerical noise.
double measured_step(double value, double deviation) {
    constexpr double clear = 0.05; // relative
    return std::max(deviation, clear * std::abs(value));
}

// What a standard deviation of each measured value does to the answer.
void vary_measured(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    for (std::size_t m = 0; m < file.measured; ++m) {
        const auto index = file.searched + m;
        const auto& parameter = file.study.parameters[index];
        const double value = *parameter.number(parameter.values.front());
        if (file.deviations[m] == 0) continue;
        const auto point = out.estimate->point;
        const double step = measured_step(value, file.deviations[m]);
        const auto run = trials.run({{point_of(point), {parameter.name, index, value + step}}}).front();
        if (!run) throw InputError({parameter.where, "the run with " + parameter.name + " raised by " + format_number(step) + " failed", "its share of the interval is not known",
                                    "see the table for the reason"});
        const auto shifted = estimate(trials.good(), priors, &*run).point;
        for (std::size_t k = 0; k < file.searched; ++k) {
            const double shift = (shifted[Eigen::Index(k)] - point[Eigen::Index(k)]) * file.deviations[m] / step;
            out.estimate->parts[k].measured.emplace_back(parameter.name, shift * shift);
        }
    }
}

void say_answer(const StudyFile& file, Identification& out) {
    const auto& estimate = *out.estimate;
    for (std::size_t k = 0; k < file.searched; ++k) {
        const auto& parameter = file.study.parameters[k];
        const double x = out.corrections.empty() ? estimate.point[Eigen::Index(k)] : out.corrections[k].value;
        const double half = ninety_percent(estimate.parts[k], estimate.freedom[k]) * std::sqrt(estimate.parts[k].total());
        const bool log = parameter.scale == study::Scale::log;
        const auto at = [&](double y) { return log ? std::exp(y) : y; };
        out.values.push_back(at(x));
        out.low.push_back(at(x - half));
        out.high.push_back(at(x + half));
    }
}

void search_and_estimate(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    auto search = search_of(file);
    while (!search->stopped()) {
        std::vector<std::pair<search::Point, Variation>> wanted;
        for (const auto& point : search->ask()) wanted.push_back({point, {}});
        const auto before = out.trials.size();
        trials.run(wanted);
        std::vector<search::Value> values;
        for (std::size_t i = before; i < out.trials.size(); ++i) {
            values.push_back(std::isnan(out.trials[i].objective) ? search::Value::failed() : search::Value::measured(out.trials[i].objective));
        }
        search->tell(values);
    }
    out.stop = search->stopped()->text;
    for (int round = 0; round < 2; ++round) {
        const auto more = runs_around(estimate(trials.good(), priors), trials.good(), search->axes());
        if (more.empty()) break;
        trials.run(more);
    }
    out.estimate = estimate(trials.good(), priors);
}
} // namespace

ViewInformation sheet_information(const ViewUncertainty& uncertainty) {
    ViewInformation out = ViewInformation::Identity(); // of the parameters that a sheet does not have
    out(sheet_time, sheet_time) = information(uncertainty.time_zero);
    out(sheet_scale, sheet_scale) = information(uncertainty.scale);
    out(sheet_right, sheet_right) = out(sheet_up, sheet_up) = information(uncertainty.shift);
    out(sheet_turn, sheet_turn) = information(uncertainty.turn);
    return out;
}

ViewInformation series_information(const ViewUncertainty& uncertainty, const Series& series) {
    ViewInformation out = ViewInformation::Identity();
    out(series_time, series_time) = information(uncertainty.time_zero);
    out(series_offset, series_offset) = information(series.offset);
    out(series_scale, series_scale) = information(uncertainty.scale);
    return out;
}

ViewInformation information_of(const ViewUncertainty& uncertainty, const std::optional<Eigen::Matrix<double, 6, 6>>& pose, double focal_deviation) {
    const auto of = information;
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

void check_searched(const StudyFile& file, const study::SceneReader& read_scene) {
    search_of(file);
    std::vector<study::Point> ends(2);
    for (const auto& parameter : file.study.parameters) {
        ends[0].push_back(parameter.word(parameter.lower));
        ends[1].push_back(parameter.word(parameter.upper));
    }
    study::candidates_of(file.study, ends, read_scene);
}

Identification identify(const StudyFile& file, const Priors& priors, study::StudyRuns& runs, const study::SceneReader& read_scene, Log& log) {
    Identification out;
    Trials trials(file, priors, runs, read_scene, log, out);
    try {
        search_and_estimate(file, priors, trials, out);
        if (file.has_rungs()) {
            measure_noise(file, priors, trials, out);
            climb_rungs(file, priors, trials, out);
        }
        vary_measured(file, priors, trials, out);
        if (file.temperature.deviation() > 0) {
            for (auto& parts : out.estimate->parts) parts.measured.emplace_back("temperature", std::pow(file.temperature.deviation(), 2));
        }
        say_answer(file, out);
        widen_to_alike_trials(file, out);
    } catch (const Trials::Stopped&) {
        out.end = study::StudyEnd::stopped;
        out.estimate.reset();
    } catch (const InputError& error) {
        out.problem = error.what();
        out.estimate.reset();
    }
    return out;
}

} // namespace treacle::identify
