#pragma once
#include "identify/answer/trials.hpp"

#include <vector>

namespace treacle::identify {

search::Point point_of(const Eigen::VectorXd& vector); // [p] coordinates as the searches take them

// A run at the estimate and one to either side of it, a few standard deviations away: the local model then agrees with
// the runs near the answer. Only for what the search has not done.
Wanted runs_around(
    const Estimate& estimate, const std::vector<EvaluatedRun>& good, const std::vector<search::Axis>& axes);

// Runs whose spacing, and with it the place of the cells in the flow, is a little another.
Wanted noise_runs(const StudyFile& file, const search::Point& point);

// A run of each finer spacing.
Wanted rung_runs(const StudyFile& file, const search::Point& point);

// A run for each measured value that is not exact, with the value raised.
Wanted measured_runs(const StudyFile& file, const search::Point& point);

// All that follows the search.
Wanted later_runs(const StudyFile& file, const search::Point& point);

} // namespace treacle::identify
