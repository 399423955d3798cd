#include "identify/answer/trials.hpp"

#include "identify/answer/early_stop.hpp"
#include "identify/experiment/digits.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
constexpr double none = std::numeric_limits<double>::quiet_NaN();

std::string short_word(const study::Parameter& parameter, double value) {
    return digits(value) + (parameter.unit.empty() ? "" : " " + parameter.unit);
}
} // namespace

std::vector<std::optional<EvaluatedRun>> Trials::run(Wanted wanted, const Cuts& cut) {
    std::vector<std::int64_t> numbers;
    std::vector<Trial> fresh;
    for (auto& [point, variation] : wanted) {
        point = run_point(point, variation);
        auto& trial = fresh.emplace_back();
        trial.purpose = variation.purpose;
        trial.values = values_at(point, variation);
        for (auto& candidate : candidates_at(trial.values)) {
            if (cut)
                candidate.cut =
                    cut(fresh.size() - 1) * double(file_.experiments.size()); // a mean over films: the others add to it
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
        keep(out.back(), wanted[i].second);
    }
    return out;
}

// Runs of the search's spacing, each once.
void Trials::keep(const std::optional<EvaluatedRun>& run, const Variation& variation) {
    if (!run || variation.parameter != Variation{}.parameter) return;
    const bool known = std::ranges::any_of(good_, [&](const EvaluatedRun& other) { return other.point == run->point; });
    if (!known) good_.push_back(*run);
}

void Trials::offer(const Wanted& expected) {
    std::vector<study::Candidate> candidates;
    for (const auto& [point, variation] : expected) {
        for (auto& one : candidates_at(values_at(run_point(point, variation), variation)))
            candidates.push_back(std::move(one));
    }
    runs_.offer(std::move(candidates));
}

// Runs beside the search's stand on a lattice of the tolerance, so that they are known before the answer's last digits are.
search::Point Trials::run_point(search::Point point, const Variation& variation) const {
    if (variation.purpose == Variation{}.purpose) return point;
    for (std::size_t k = 0; k < point.size(); ++k) {
        const auto& axis = axes_[k];
        point[k] = std::clamp(
            axis.start + axis.tolerance * std::round((point[k] - axis.start) / axis.tolerance), axis.lower, axis.upper);
    }
    return point;
}

std::vector<double> Trials::values_at(const search::Point& point, const Variation& variation) const {
    std::vector<double> out;
    for (std::size_t k = 0; k < file_.study.parameters.size(); ++k) {
        const auto& parameter = file_.study.parameters[k];
        const double usual =
            k < point.size() ? value_of(parameter, point[k]) : *parameter.number(parameter.values.front());
        out.push_back(k == variation.parameter ? variation.value : usual);
    }
    return out;
}

std::vector<study::Candidate> Trials::candidates_at(const std::vector<double>& values) const {
    study::Point words;
    for (std::size_t k = 0; k < values.size(); ++k) words.push_back(file_.study.parameters[k].word(values[k]));
    std::vector<study::Candidate> out;
    for (const auto& scene : file_.study.scenes)
        out.push_back(study::candidate_of(file_.study, scene, words, read_scene_));
    return out;
}

std::optional<EvaluatedRun> Trials::evaluate(Trial& trial, const search::Point& point) const {
    trial.objective = none;
    trial.bound = bound_of_runs(file_, runs_, trial.runs);
    auto run = evaluated_runs(file_, runs_, trial.runs);
    if (!run) return {};
    run->point = Eigen::Map<const Eigen::VectorXd>(point.data(), Eigen::Index(point.size()));
    trial.objective = residual_objective(*run, priors_);
    for (const auto& one : run->experiments) trial.mismatches.push_back(one.mismatch);
    return run;
}

void Trials::tell(const Trial& trial) const {
    std::string line = "trial " + std::to_string(out_.trials.size() + 1) + " (" + trial.purpose + ")";
    for (std::size_t k = 0; k < trial.values.size(); ++k)
        line += "  " + file_.study.parameters[k].name + " " + short_word(file_.study.parameters[k], trial.values[k]);
    const std::string what = file_.search.objective == Objective::mismatch ? "  E " : "  objective ";
    log_.line(line + (trial.bound                      ? what + ">= " + digits(*trial.bound) + ", stopped early"
                         : std::isnan(trial.objective) ? "  failed"
                                                       : what + digits(sought(file_, trial))));
}

} // namespace treacle::identify
