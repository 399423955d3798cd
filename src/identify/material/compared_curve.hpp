#pragma once
#include "identify/answer/identification.hpp"
#include "identify/material/curve_fit.hpp"

#include <optional>

namespace treacle::identify {

// The run with the liquid as a rheometer measured it, beside the run at the answer; both have one spacing.
struct ComparedCurve {
    std::string liquid;          // empty: it is not clear which one the curve is of
    std::optional<CurveFit> fit; // nothing without a liquid
    std::optional<Trial>
        trial; // at the curve; values that the curve sets are not a number there. Nothing where there is no run
    std::vector<double> misfits;   // by experiment of misfits_of_run; empty where a run failed
    std::vector<double> at_answer; // the same of the run at the answer
    std::string problem;           // why there is no run, or none that is whole; a sentence without its full stop
};

// Sentences: the law, how far it is from the curve, and both misfits; or why there are none.
std::vector<std::string> describe(const ComparedCurve& compared, const StudyFile& file);
// Block `compared_curve` of result.yaml.
std::string yaml(const ComparedCurve& compared, const StudyFile& file);

} // namespace treacle::identify
