#include "identify/answer/early_stop.hpp"

#include <cmath>
#include <numeric>

namespace treacle::identify {

double sought(const StudyFile& file, const Trial& trial) {
    if (file.search.objective == Objective::displacements || trial.mismatches.empty()) return trial.objective;
    return std::accumulate(trial.mismatches.begin(), trial.mismatches.end(), 0.0) / double(trial.mismatches.size());
}

search::Value value_for_search(const StudyFile& file, const Trial& trial) {
    if (trial.bound) return search::Value::at_least(*trial.bound);
    return std::isnan(trial.objective) ? search::Value::failed() : search::Value::measured(sought(file, trial));
}

namespace {

void add_mismatches(const StudyFile& file, std::size_t scene, const std::filesystem::path& folder, double& sum) {
    for (const auto& experiment : file.experiments) {
        if (&file.scene_of(experiment) == &file.study.scenes[scene])
            sum += read_residuals(folder, experiment.name, experiment.kind).mismatch;
    }
}

} // namespace

std::optional<double> bound_of_runs(
    const StudyFile& file, const study::StudyRuns& runs, const std::vector<std::int64_t>& numbers) {
    bool any = false;
    for (const auto number : numbers) {
        const auto* outcome = runs.journal().outcome(number);
        if (!outcome || study::is_failure(outcome->status)) return {};
        any = any || outcome->status == study::RunStatus::stopped_early;
    }
    if (!any) return {};
    double sum = 0;
    for (std::size_t s = 0; s < numbers.size(); ++s) {
        const auto& outcome = *runs.journal().outcome(numbers[s]);
        sum += outcome.bound; // 0 of those that are whole
        if (outcome.status != study::RunStatus::stopped_early) add_mismatches(file, s, runs.folder_of(numbers[s]), sum);
    }
    return sum / double(file.experiments.size());
}

} // namespace treacle::identify
