#include "identify/answer/identification.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "identify/answer/early_stop.hpp"
#include "identify/answer/profile.hpp"
#include "identify/estimate/directions.hpp"
#include "identify/estimate/repeats.hpp"
#include "identify/experiment/digits.hpp"
#include "search/bracketing/bracketing.hpp"
#include "search/cma_es/cma_es.hpp"
#include "search/gradient/gauss_newton.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
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
    const bool automatic = file.search.method == Method::automatic;
    if (file.search.method == Method::bracketing || (automatic && axes.size() == 1)) {
        if (axes.size() == 1) return std::make_unique<search::Bracketing>(axes.front(), limits);
        throw InputError({file.study.path.string(), "search.method = bracketing, for " + std::to_string(axes.size()) + " parameters", "it brackets one",
                          "write search: gauss_newton"});
    }
    if (file.search.method == Method::gauss_newton || (automatic && file.search.objective == Objective::displacements)) {
        search::GaussNewtonOptions options;
        options.limits = limits;
        return std::make_unique<search::GaussNewton>(axes, options);
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

using Wanted = std::vector<std::pair<search::Point, Variation>>;

// Runs candidates and keeps what came of them.
class Trials {
public:
    Trials(const StudyFile& file, const Priors& priors, study::StudyRuns& runs, const study::SceneReader& read_scene, Log& log, Identification& out)
        : file_(file), priors_(priors), runs_(runs), read_scene_(read_scene), log_(log), out_(out) {}

    // Of each point and its variation: nothing where a run failed or stopped early. Runs may do that where the search's objective of the k-th
    // point is above cut(k), infinite where it may not. Throws Stopped when asked to stop.
    struct Stopped {};
    using Cuts = std::function<double(std::size_t)>;
    std::vector<std::optional<EvaluatedRun>> run(Wanted wanted, const Cuts& cut = {}) {
        std::vector<std::int64_t> numbers;
        std::vector<Trial> fresh;
        for (auto& [point, variation] : wanted) {
            point = run_point(point, variation);
            auto& trial = fresh.emplace_back();
            trial.purpose = variation.purpose;
            trial.values = values_at(point, variation);
            for (auto& candidate : candidates_at(trial.values)) {
                if (cut) candidate.cut = cut(fresh.size() - 1) * double(file_.experiments.size()); // a mean over films: the others add to it
                trial.runs.push_back(runs_.ask(candidate));
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
    // Lanes that would idle while later calls of `run` wait may do these meanwhile; without any, they end.
    void offer(const Wanted& expected) {
        std::vector<study::Candidate> candidates;
        for (const auto& [point, variation] : expected) {
            for (auto& one : candidates_at(values_at(run_point(point, variation), variation))) candidates.push_back(std::move(one));
        }
        runs_.offer(std::move(candidates));
    }
    bool speculates() const { return file_.study.runs.speculate && runs_.lanes() > 1; }
    // Of the search's spacing and the measured values as they are.
    const std::vector<EvaluatedRun>& good() const { return good_; }

private:
    // Runs beside the search's stand on a lattice of the tolerance, so that they are known before the answer's last digits are.
    search::Point run_point(search::Point point, const Variation& variation) const {
        if (variation.purpose == Variation{}.purpose) return point;
        for (std::size_t k = 0; k < point.size(); ++k) {
            const auto& axis = axes_[k];
            point[k] = std::clamp(axis.start + axis.tolerance * std::round((point[k] - axis.start) / axis.tolerance), axis.lower, axis.upper);
        }
        return point;
    }
    std::vector<double> values_at(const search::Point& point, const Variation& variation) const {
        std::vector<double> out;
        for (std::size_t k = 0; k < file_.study.parameters.size(); ++k) {
            const auto& parameter = file_.study.parameters[k];
            const double usual = k < point.size() ? value_of(parameter, point[k]) : *parameter.number(parameter.values.front());
            out.push_back(k == variation.parameter ? variation.value : usual);
        }
        return out;
    }
    std::vector<study::Candidate> candidates_at(const std::vector<double>& values) const {
        study::Point words;
        for (std::size_t k = 0; k < values.size(); ++k) words.push_back(file_.study.parameters[k].word(values[k]));
        std::vector<study::Candidate> out;
        for (const auto& scene : file_.study.scenes) out.push_back(study::candidate_of(file_.study, scene, words, read_scene_));
        return out;
    }
    std::optional<EvaluatedRun> evaluate(Trial& trial, const search::Point& point) const {
        trial.objective = none;
        trial.bound = bound_of_runs(file_, runs_, trial.runs);
        auto run = evaluated_runs(file_, runs_, trial.runs);
        if (!run) return {};
        run->point = Eigen::Map<const Eigen::VectorXd>(point.data(), Eigen::Index(point.size()));
        trial.objective = residual_objective(*run, priors_);
        for (const auto& one : run->experiments) trial.mismatches.push_back(one.mismatch);
        return run;
    }
    void tell(const Trial& trial) const {
        std::string line = "trial " + std::to_string(out_.trials.size() + 1) + " (" + trial.purpose + ")";
        for (std::size_t k = 0; k < trial.values.size(); ++k) line += "  " + file_.study.parameters[k].name + " " + short_word(file_.study.parameters[k], trial.values[k]);
        const std::string what = file_.search.objective == Objective::mismatch ? "  E " : "  objective ";
        log_.line(line + (trial.bound ? what + ">= " + digits(*trial.bound) + ", stopped early" : std::isnan(trial.objective) ? "  failed" : what + digits(sought(file_, trial))));
    }
    static std::string short_word(const study::Parameter& parameter, double value) {
        return digits(value) + (parameter.unit.empty() ? "" : " " + parameter.unit);
    }

    const StudyFile& file_;
    const Priors& priors_;
    study::StudyRuns& runs_;
    const study::SceneReader& read_scene_;
    Log& log_;
    Identification& out_;
    std::vector<search::Axis> axes_ = axes_of(file_);
    std::vector<EvaluatedRun> good_;
};

// A run at the estimate and one to either side of it, a few standard deviations away: the local model then says what the
// runs near the answer say. Only for what the search has not done.
Wanted runs_around(const Estimate& estimate, const std::vector<EvaluatedRun>& good, const std::vector<search::Axis>& axes) {
    constexpr double reach = 0.12, near = 0.03; // of the logarithm of a viscosity
    Wanted out;
    const auto p = std::size_t(estimate.point.size());
    if (p > 1) {
        std::vector<Eigen::VectorXd> points;
        for (const auto& run : good) points.push_back(run.point);
        for (const auto& point : points_to_span(estimate.point, points, axes)) out.push_back({point, {"around the answer"}});
        return out;
    }
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

search::Point point_of(const Eigen::VectorXd& vector) { return {vector.data(), vector.data() + vector.size()}; }

// Runs whose spacing, and with it the place of the cells in the flow, is a little another.
Wanted noise_runs(const StudyFile& file, const search::Point& point) {
    constexpr std::array factors{0.985, 1.015, 0.97, 1.03, 0.955, 1.045, 0.94, 1.06};
    const auto spacing = file.searched + file.measured;
    const auto& parameter = file.study.parameters[spacing];
    const double width = *parameter.number(parameter.values.front());
    Wanted out;
    for (int i = 0; i < file.search.noise_runs; ++i) out.push_back({point, {"noise", spacing, width * factors[std::size_t(i)]}});
    return out;
}

// A run of each finer spacing.
Wanted rung_runs(const StudyFile& file, const search::Point& point) {
    const auto spacing = file.searched + file.measured;
    const auto& parameter = file.study.parameters[spacing];
    Wanted out;
    for (std::size_t i = 1; i < parameter.values.size(); ++i) out.push_back({point, {"rung " + parameter.values[i], spacing, *parameter.number(parameter.values[i])}});
    return out;
}

// Step by which a measured value is changed to see what it does: far enough that the change stands out of the numerical noise.
double measured_step(double value, double deviation) {
    constexpr double clear = 0.05; // relative
    return std::max(deviation, clear * std::abs(value));
}

// A run for each measured value that is not exact, with the value raised.
Wanted measured_runs(const StudyFile& file, const search::Point& point) {
    Wanted out;
    for (std::size_t m = 0; m < file.measured; ++m) {
        const auto index = file.searched + m;
        const auto& parameter = file.study.parameters[index];
        const double value = *parameter.number(parameter.values.front());
        if (file.deviations[m] != 0) out.push_back({point, {parameter.name, index, value + measured_step(value, file.deviations[m])}});
    }
    return out;
}

// All that follows the search.
Wanted later_runs(const StudyFile& file, const search::Point& point) {
    Wanted out;
    const auto add = [&](const Wanted& more) { out.insert(out.end(), more.begin(), more.end()); };
    if (file.has_rungs()) {
        add(noise_runs(file, point));
        add(rung_runs(file, point));
    }
    add(measured_runs(file, point));
    return out;
}

// Runs at one spacing until the answer there stands, at most `most` of them: at the answer so far, and then where it moves to. A run to
// the side, unless the answer moves by itself, says how displacements change at this spacing: where the flow is wild, the
// coarse runs tell that wrongly. A run that fails is followed by one beside it. False where no run succeeded.
bool settle_rung(const StudyFile& file, const Priors& priors, Trials& trials, std::vector<std::vector<EvaluatedRun>>& finer, std::size_t rung, Eigen::VectorXd& point) {
    constexpr double near = 0.03, reach = 0.15; // of the logarithm of a viscosity
    constexpr std::size_t most = 4;
    constexpr int most_failures = 3;
    finer.emplace_back();
    auto next = point;
    int failures = 0;
    while (finer.back().size() < most) {
        const auto run = trials.run({rung_runs(file, point_of(next))[rung]}).front();
        if (!run) { // its failure stands in the table
            if (++failures == most_failures) break;
            next.array() += (failures % 2 == 1 ? reach : -2 * reach);
            continue;
        }
        finer.back().push_back(*run);
        point = estimate(trials.good(), priors, finer, range_prior(file)).point;
        const auto distance = [&](const EvaluatedRun& one) { return (one.point - point).cwiseAbs().maxCoeff(); };
        const bool moved = std::ranges::all_of(finer.back(), [&](const EvaluatedRun& one) { return distance(one) > near; });
        next = point;
        if (moved) continue;
        if (finer.back().size() > 1) break;
        const Eigen::VectorXd way = point - finer.back().front().point;
        next = finer.back().front().point + (way.norm() > 0 ? Eigen::VectorXd(way * (reach / way.norm())) : Eigen::VectorXd::Constant(way.size(), reach));
    }
    if (!finer.back().empty()) return true;
    finer.pop_back();
    return false;
}

// The pixels' part of the interval and all that is said of the fit are those of the finest runs.
void take_fit(const Estimate& finest, Estimate& out) {
    auto parts = finest.parts;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        parts[k].noise = out.parts[k].noise;
        parts[k].resolution = out.parts[k].resolution;
    }
    const auto point = out.point;
    const auto alike = out.alike;
    out = finest;
    out.parts = std::move(parts);
    out.point = point;
    out.alike = alike;
}

search::Extrapolation at_finest(search::Extrapolation found) {
    found.value -= found.correction;
    found.correction = 0;
    found.deviation = found.noise;
    found.text = "the answer is that of the finest rung, as the study asks";
    return found;
}

// Numerical noise around the coarsest answer.
struct NoiseMeasure {
    int freedom = 0;                       // degrees of freedom of Identification::noise
    std::optional<ResolutionAnswer> answer; // mean over the runs that it was measured by
};

// The answer at each finer rung.
void climb_rungs(const StudyFile& file, const Priors& priors, const NoiseMeasure& noise, Trials& trials, Identification& out) {
    const auto& parameter = file.study.parameters[file.searched + file.measured];
    auto point = out.estimate->point;
    std::vector<ResolutionAnswer> answers;
    const auto keep = [&](const std::string& word, const ResolutionAnswer& found) {
        RungAnswer answer{word, {}};
        for (std::size_t k = 0; k < file.searched; ++k) answer.values.push_back(value_of(file.study.parameters[k], found.value[Eigen::Index(k)]));
        answers.push_back(found);
        out.rungs.push_back(answer);
    };
    const auto found_by = [&](const std::string& word, std::size_t runs) {
        constexpr std::size_t near = 2; // runs that are near enough to the answer to lessen its noise
        return ResolutionAnswer{*parameter.number(word), int(std::min(runs, near)), point};
    };
    const auto& coarsest = parameter.values.front();
    keep(coarsest, noise.answer ? *noise.answer : found_by(coarsest, out.estimate->runs));
    std::vector<std::vector<EvaluatedRun>> finer;
    for (std::size_t i = 1; i < parameter.values.size(); ++i) {
        if (settle_rung(file, priors, trials, finer, i - 1, point)) keep(parameter.values[i], found_by(parameter.values[i], finer.back().size()));
    }
    if (finer.empty()) return;
    take_fit(estimate(trials.good(), priors, finer, range_prior(file)), *out.estimate);
    auto resolved = extrapolate_answers(answers, out.estimate->covariance, out.noise, noise.freedom);
    if (file.search.answer == Answer::finest) {
        resolved.value = answers.back().value;
        resolved.resolution.setZero();
        for (auto& one : resolved.axes) one = at_finest(one);
    }
    out.resolved = resolved.value;
    if (const auto range = range_prior(file); range.lower.size() > 0) out.resolved = resolved.value.cwiseMax(range.lower).cwiseMin(range.upper);
    out.corrections = resolved.axes;
    out.noise = resolved.noise;
    out.covariance += resolved.resolution;
    for (std::size_t k = 0; k < file.searched; ++k) {
        const auto i = Eigen::Index(k);
        out.estimate->parts[k].noise = resolved.noise(i, i);
        out.estimate->parts[k].resolution = resolved.resolution(i, i);
    }
}

// Scatter of few runs, of one parameter on a logarithmic scale, taken together with what it usually is, which counts as one run: two answers
// can be alike by chance, and the interval would believe it. Returns the degrees of freedom.
int expect_usual_noise(const StudyFile& file, int freedom, Eigen::MatrixXd& noise) {
    constexpr double usual = 0.01; // of the logarithm of a viscosity; 0.5 to 2 % in the templates' scenes at their coarsest spacing
    if (file.searched != 1 || file.study.parameters.front().scale != study::Scale::log) return freedom;
    noise(0, 0) = (noise(0, 0) * freedom + usual * usual) / (freedom + 1);
    return freedom + 1;
}

// Scatter of the answer over runs of spacings near the coarsest, and their mean, which has less of it than the answer of the search.
NoiseMeasure measure_noise(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    const auto& parameter = file.study.parameters[file.searched + file.measured];
    std::vector<Eigen::VectorXd> answers{out.estimate->point};
    double spacings = *parameter.number(parameter.values.front());
    const auto wanted = noise_runs(file, point_of(out.estimate->point));
    const auto evaluated = trials.run(wanted);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (!evaluated[i]) continue;
        answers.push_back(estimate(trials.good(), priors, {{*evaluated[i]}}, range_prior(file)).point);
        spacings += wanted[i].second.value;
    }
    if (answers.size() < 2) return {};
    const double count = double(answers.size());
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(out.estimate->point.size());
    for (const auto& one : answers) mean += one / count;
    for (const auto& one : answers) out.noise += (one - mean) * (one - mean).transpose() / (count - 1);
    const int runs = int(answers.size()), freedom = expect_usual_noise(file, runs - 1, out.noise);
    for (std::size_t k = 0; k < file.searched; ++k) out.estimate->parts[k].noise = out.noise(Eigen::Index(k), Eigen::Index(k));
    return {freedom, ResolutionAnswer{spacings / count, runs, mean}};
}

// What a standard deviation of each measured value does to the answer.
void vary_measured(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    const auto point = out.estimate->point;
    for (const auto& wanted : measured_runs(file, point_of(point))) {
        const auto index = wanted.second.parameter;
        const auto& parameter = file.study.parameters[index];
        const double deviation = file.deviations[index - file.searched];
        double step = wanted.second.value - *parameter.number(parameter.values.front());
        auto run = trials.run({wanted}).front();
        if (!run) {
            auto lowered = wanted;
            lowered.second.value -= 2 * step;
            step = -step;
            run = trials.run({lowered}).front();
        }
        if (!run) throw InputError({parameter.where, "the runs with " + parameter.name + " raised and lowered by " + format_number(-step) + " failed",
                                    "its share of the interval is not known", "see the table for the reason"});
        const Eigen::VectorXd shift = (estimate(trials.good(), priors, {{*run}}, range_prior(file)).point - point) * deviation / step;
        for (std::size_t k = 0; k < file.searched; ++k) out.estimate->parts[k].measured.emplace_back(parameter.name, shift[Eigen::Index(k)] * shift[Eigen::Index(k)]);
        out.covariance += shift * shift.transpose();
    }
}

// With several clips of one set-up the answer is the mean of theirs; what they differ by beyond their own noise enters the interval.
void add_clips(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    const auto scatter = between_clips(trials.good(), priors, set_ups(file.experiments));
    if (!scatter) return;
    out.estimate->point += scatter->shift;
    for (std::size_t k = 0; k < out.corrections.size(); ++k) out.corrections[k].value += scatter->shift[Eigen::Index(k)];
    for (std::size_t k = 0; k < file.searched; ++k) {
        out.estimate->parts[k].clips = scatter->variance[Eigen::Index(k)];
        out.estimate->parts[k].clip_freedom = scatter->freedom;
    }
}

void say_answer(const StudyFile& file, Identification& out) {
    const auto& estimate = *out.estimate;
    out.covariance += estimate.covariance + out.noise;
    const Eigen::VectorXd answer = out.resolved.size() > 0 ? out.resolved : estimate.point;
    for (std::size_t k = 0; k < file.searched; ++k) { // what else there is moves each parameter by itself
        const auto i = Eigen::Index(k);
        out.covariance(i, i) = std::max(out.covariance(i, i), estimate.parts[k].total());
    }
    for (std::size_t k = 0; k < file.searched; ++k) {
        const auto& parameter = file.study.parameters[k];
        const double x = answer[Eigen::Index(k)];
        const double half = ninety_percent(estimate.parts[k], estimate.freedom[k]) * std::sqrt(estimate.parts[k].total());
        const bool log = parameter.scale == study::Scale::log;
        const auto at = [&](double y) { return log ? std::exp(y) : y; };
        out.values.push_back(at(x));
        out.low.push_back(at(x - half));
        out.high.push_back(at(x + half));
    }
}

// Runs that may follow those that the search asks for now: its own next ones, and those at the answer that can be told so far.
Wanted expected_runs(const StudyFile& file, const Priors& priors, const Trials& trials, const search::Search& search) {
    Wanted out;
    if (!trials.speculates()) return out;
    for (const auto& point : search.speculate()) out.push_back({point, {}});
    if (trials.good().size() <= file.searched) return out;
    const auto so_far = estimate(trials.good(), priors, {}, range_prior(file));
    for (const auto& one : runs_around(so_far, trials.good(), search.axes())) out.push_back(one);
    for (const auto& one : later_runs(file, point_of(so_far.point))) out.push_back(one);
    return out;
}

std::vector<std::vector<double>> residuals_of(const std::vector<std::optional<EvaluatedRun>>& runs, const Priors& priors) {
    std::vector<std::vector<double>> out;
    for (const auto& run : runs) out.push_back(run ? search_residuals(*run, priors) : std::vector<double>());
    return out;
}

void search_and_estimate(const StudyFile& file, const Priors& priors, Trials& trials, Identification& out) {
    auto search = search_of(file);
    while (!search->stopped()) {
        Wanted wanted;
        for (const auto& point : search->ask()) wanted.push_back({point, {}});
        trials.offer(expected_runs(file, priors, trials, *search));
        const auto before = out.trials.size();
        const auto cut = [&](std::size_t k) { return search->cut(k); };
        const auto evaluated = trials.run(wanted, file.search.stops_early() ? Trials::Cuts(cut) : Trials::Cuts());
        if (search->uses_residuals() && file.search.objective == Objective::displacements) search->tell_residuals(residuals_of(evaluated, priors));
        std::vector<search::Value> values;
        for (std::size_t i = before; i < out.trials.size(); ++i) {
            values.push_back(value_for_search(file, out.trials[i]));
        }
        search->tell(values);
    }
    out.stop = search->stopped()->text;
    for (int round = 0; round < 2; ++round) {
        const auto more = runs_around(estimate(trials.good(), priors, {}, range_prior(file)), trials.good(), search->axes());
        if (more.empty()) break;
        trials.offer(expected_runs(file, priors, trials, *search));
        trials.run(more);
    }
    out.estimate = estimate(trials.good(), priors, {}, range_prior(file));
    trials.offer(later_runs(file, point_of(out.estimate->point)));
}
} // namespace

const Trial* best_trial(const Identification& identification) {
    const Trial* best = nullptr;
    for (const auto& trial : identification.trials) {
        if (!std::isnan(trial.objective) && (!best || trial.objective < best->objective)) best = &trial;
    }
    return best;
}

const Trial* trial_at_answer(const StudyFile& file, const Identification& identification) {
    if (!file.has_rungs()) return best_trial(identification);
    const auto& spacing = file.study.parameters.back();
    const double finest = *spacing.number(spacing.values.back());
    const Trial* best = nullptr;
    for (const auto& trial : identification.trials) {
        if (!std::isnan(trial.objective) && trial.values.back() == finest && (!best || trial.objective < best->objective)) best = &trial;
    }
    return best ? best : best_trial(identification);
}

std::optional<EvaluatedRun> evaluated_runs(const StudyFile& file, const study::StudyRuns& runs, const std::vector<std::int64_t>& numbers) {
    EvaluatedRun out;
    for (const auto& experiment : file.experiments) {
        const auto number = numbers[std::size_t(&file.scene_of(experiment) - file.study.scenes.data())];
        const auto* outcome = runs.journal().outcome(number);
        if (!outcome || outcome->status != study::RunStatus::done) return {};
        out.experiments.push_back(read_residuals(runs.folder_of(number), experiment.name, experiment.kind));
    }
    return out;
}

RangePrior range_prior(const StudyFile& file) {
    RangePrior out;
    if (file.searched < 2) return out;
    const auto axes = axes_of(file);
    out.lower = out.upper = Eigen::VectorXd(Eigen::Index(axes.size()));
    for (std::size_t k = 0; k < axes.size(); ++k) {
        out.lower[Eigen::Index(k)] = axes[k].lower;
        out.upper[Eigen::Index(k)] = axes[k].upper;
    }
    return out;
}

void check_searched(const StudyFile& file, const study::SceneReader& read_scene) {
    search_of(file);
    check_scatter_is_measured(file);
    std::vector<study::Point> ends(2);
    for (const auto& parameter : file.study.parameters) {
        ends[0].push_back(parameter.word(parameter.lower));
        ends[1].push_back(parameter.word(parameter.upper));
    }
    study::candidates_of(file.study, ends, read_scene);
}

Identification identify(const StudyFile& file, const Priors& priors, study::StudyRuns& runs, const study::SceneReader& read_scene, Log& log) {
    Identification out;
    out.noise = out.covariance = Eigen::MatrixXd::Zero(Eigen::Index(file.searched), Eigen::Index(file.searched));
    Trials trials(file, priors, runs, read_scene, log, out);
    try {
        search_and_estimate(file, priors, trials, out);
        if (file.has_rungs()) {
            const auto noise = measure_noise(file, priors, trials, out);
            climb_rungs(file, priors, noise, trials, out);
        }
        vary_measured(file, priors, trials, out);
        add_clips(file, priors, trials, out);
        if (file.temperature.deviation() > 0) {
            for (auto& parts : out.estimate->parts) parts.measured.emplace_back("temperature", std::pow(file.temperature.deviation(), 2));
        }
        trials.offer({});
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
