#pragma once
#include "identify/estimate/estimate.hpp"
#include "identify/estimate/view_priors.hpp"
#include "identify/experiment/study_file.hpp"
#include "search/problem/search.hpp"
#include "search/rungs.hpp"
#include "study/study_runs.hpp"

namespace treacle::identify {

// One candidate and what came of it.
struct Trial {
    std::vector<double> values;     // of all parameters of the study, in their units
    std::vector<std::int64_t> runs; // one a scene
    double objective = 0;           // residual_objective; not a number where a run failed or stopped early
    std::vector<double>
        mismatches; // by experiment: (6.9), mean over frames; (E.1) [m2/s2]; mean square of a series. Empty where a run failed or stopped early
    std::optional<double> bound = {}; // of the search's objective, where a run stopped early: what it is at least
    std::string purpose;              // "search", "around the answer", "rung 4 mm", "noise", "density"
};

// The answer at one spacing.
struct RungAnswer {
    std::string spacing;
    std::vector<double> values; // of the searched parameters, in their units
};

// Result of identify(): every run that was done, the fit, and the answer with its interval.
struct Identification {
    study::StudyEnd end = study::StudyEnd::complete; // stopped: before its end, with what was reached
    std::string stop;                                // why the search ended, a sentence
    std::vector<Trial> trials;                       // in their order
    std::optional<Estimate>
        estimate; // nothing when stopped, or without good runs; its point is that of the search's spacing
    std::vector<RungAnswer> rungs;                  // the coarsest first
    std::vector<search::Extrapolation> corrections; // [p] to spacing 0, along the principal axes of the coordinates
    Eigen::VectorXd resolved;                       // [p] coordinates at spacing 0; empty without rungs
    Eigen::MatrixXd
        noise; // [p][p] of the coordinates, numerical: of one run at the coarsest spacing, until there are finer ones
    std::vector<double> values;    // [p] identified, in the parameters' units
    std::vector<double> low, high; // ends of the 90 % interval
    Eigen::MatrixXd covariance;    // [p][p] of the coordinates (the logarithm of a viscosity), of all parts
    std::string problem;           // why there is no estimate
};

// Prior knowledge of several parameters by their ranges; none of a single one.
RangePrior range_prior(const StudyFile& file);

// The trial with the least objective; null without one.
const Trial* best_trial(const Identification& identification);

// The trial with the least objective among those at the finest spacing of the study; the best trial where none of these
// has runs.
const Trial* trial_at_answer(const StudyFile& file, const Identification& identification);

// Residuals of the runs of a trial, one a scene of the study, from its experiments, without a point; nothing where one
// has failed. Throws InputError.
std::optional<EvaluatedRun> evaluated_runs(
    const StudyFile& file, const study::StudyRuns& runs, const std::vector<std::int64_t>& numbers);

// Throws InputError without a parameter, for one without a range, for one on which silhouettes do not depend, and for
// ends of ranges that a scene refuses.
void check_searched(const StudyFile& file, const study::SceneReader& read_scene);

// Searches the study's parameters for the least difference of contours, fits the answer to the runs around the least one,
// corrects it by finer rungs, and adds to its interval what the resolution, the numerical noise and each measured value make
// of it, a run each. Runs are those of the study: done once, in order, resumed after any stop.
Identification identify(const StudyFile& file, const Priors& priors, study::StudyRuns& runs,
    const study::SceneReader& read_scene, Log& log);

} // namespace treacle::identify
