#pragma once
#include "identify/answer/identification.hpp"

namespace treacle::identify {

// The search's objective of a trial whose runs are whole: displacements, or the mean over films of (6.9).
double sought(const StudyFile& file, const Trial& trial);

// Value of a trial for the search.
search::Value value_for_search(const StudyFile& file, const Trial& trial);

// Lower bound of the mean over films of (6.9), where one of a trial's runs, one a scene, stopped early and none failed: bounds and values
// of its scenes add up. Nothing where all are whole. Throws InputError.
std::optional<double> bound_of_runs(
    const StudyFile& file, const study::StudyRuns& runs, const std::vector<std::int64_t>& numbers);

} // namespace treacle::identify
