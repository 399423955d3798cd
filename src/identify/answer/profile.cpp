#include "identify/answer/profile.hpp"

#include "base/text/error.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
bool of_search(const Trial& trial) {
    return !std::isnan(trial.objective) && (trial.purpose == "search" || trial.purpose == "around the answer");
}

// By how much objectives of equal parameters may differ, in 90 % of pairs of runs.
double numerical_scatter(const Identification& identification) {
    std::vector<double> objectives;
    for (const auto& trial : identification.trials) {
        if (trial.purpose == "noise" && !std::isnan(trial.objective)) objectives.push_back(trial.objective);
    }
    if (objectives.size() < 2) return 0;
    double mean = 0, square = 0;
    for (const double one : objectives) mean += one / double(objectives.size());
    for (const double one : objectives) square += (one - mean) * (one - mean);
    return 1.645 * std::sqrt(2 * square / double(objectives.size() - 1));
}

// Value at the answer for one at the search's spacing: moved as the rungs have moved the answer.
double at_answer(const study::Parameter& parameter, std::size_t k, double value, const Identification& identification) {
    if (identification.rungs.empty()) return value;
    const double coarse = identification.rungs.front().values[k], answer = identification.values[k];
    const double moved = parameter.scale == study::Scale::log ? value * answer / coarse : value + answer - coarse;
    return std::clamp(moved, parameter.lower, parameter.upper);
}
} // namespace

bool prescribes(const Experiment& experiment) {
    return experiment.kind == ExperimentKind::piv && experiment.piv.has_track() &&
           experiment.piv.ball.motion == BallMotion::prescribed;
}

void check_scatter_is_measured(const StudyFile& file) {
    if (file.experiments.empty() || !std::ranges::all_of(file.experiments, prescribes)) return;
    if (file.has_rungs() && file.search.noise_runs >= 2) return;
    throw InputError({file.experiments.front().piv.where,
        "the ball follows a prescribed path, which needs search.rungs, and noise_runs of two or more",
        "at low Reynolds number viscosities differ by less than resolutions do, and the answer would be that of the "
        "numerical noise",
        "write for instance search: {rungs: [3 mm, 2.4 mm, 2 mm]}, or let the ball fall freely: ball: {track: "
        "track.csv, motion: free}"});
}

void widen_to_alike_trials(const StudyFile& file, Identification& identification) {
    if (!identification.estimate) return;
    double best = 1e300;
    for (const auto& trial : identification.trials) {
        if (of_search(trial)) best = std::min(best, trial.objective);
    }
    const bool scatter_decides = std::ranges::all_of(file.experiments, prescribes);
    const double chance =
        std::max(identification.estimate->alike, scatter_decides ? numerical_scatter(identification) : 0.0);
    for (const auto& trial : identification.trials) {
        if (!of_search(trial) || trial.objective > best + chance) continue;
        for (std::size_t k = 0; k < file.searched; ++k) {
            const double value = at_answer(file.study.parameters[k], k, trial.values[k], identification);
            identification.low[k] = std::min(identification.low[k], value);
            identification.high[k] = std::max(identification.high[k], value);
        }
    }
}

} // namespace treacle::identify
