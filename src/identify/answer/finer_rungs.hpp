#pragma once
#include "identify/answer/trials.hpp"
#include "identify/estimate/directions.hpp"

#include <optional>

namespace treacle::identify {

// Numerical noise around the coarsest answer.
struct NoiseMeasure {
    int freedom = 0;                        // degrees of freedom of Identification::noise
    std::optional<ResolutionAnswer> answer; // mean over the runs that it was measured by
};

// The answer at each finer rung, and at spacing 0: adds runs, and writes the rungs, the resolved answer and its share of the interval.
void climb_rungs(
    const StudyFile& file, const Priors& priors, const NoiseMeasure& noise, Trials& trials, Identification& out);

} // namespace treacle::identify
