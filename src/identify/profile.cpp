#include "identify/profile.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::identify {

namespace {
bool of_search(const Trial& trial) { return !std::isnan(trial.objective) && (trial.purpose == "search" || trial.purpose == "around the answer"); }

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
} // namespace

void widen_to_alike_trials(const StudyFile& file, Identification& identification) {
    if (!identification.estimate) return;
    double best = 1e300;
    for (const auto& trial : identification.trials) {
        if (of_search(trial)) best = std::min(best, trial.objective);
    }
    const double chance = std::max(identification.estimate->alike, numerical_scatter(identification));
    for (const auto& trial : identification.trials) {
        if (!of_search(trial) || trial.objective > best + chance) continue;
        for (std::size_t k = 0; k < file.searched; ++k) {
            identification.low[k] = std::min(identification.low[k], trial.values[k]);
            identification.high[k] = std::max(identification.high[k], trial.values[k]);
        }
    }
}

} // namespace treacle::identify
