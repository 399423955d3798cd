#pragma once
#include "identify/estimate.hpp"
#include "identify/study_file.hpp"
#include "search/search.hpp"
#include "study/study_runs.hpp"

namespace treacle::identify {

// One candidate of a search and what came of it.
struct Trial {
    std::vector<double> values;  // of the parameters, in their units
    std::vector<std::int64_t> runs; // one a scene
    double objective = 0;        // contour_objective; not a number where a run failed
    double mismatch = 0;         // (6.9), mean over frames and experiments
};

struct Identification {
    study::StudyEnd end = study::StudyEnd::complete;
    std::string stop; // why the search ended, a sentence
    std::vector<Trial> trials; // in the order of the search
    std::optional<Estimate> estimate; // nothing when stopped, or without good runs
    std::vector<double> values; // [p] identified, in the parameters' units
    std::vector<double> low, high; // ends of the 90 % interval
    std::string problem; // why there is no estimate
};

// What the films say of the view before they are looked at, per experiment.
using Priors = std::vector<ViewInformation>;
ViewInformation information_of(const ViewUncertainty& uncertainty, const std::optional<Eigen::Matrix<double, 6, 6>>& pose, double focal_deviation);

// Searches the study's parameters for the least difference of contours, and fits the answer with its interval to the runs
// around the least one. Runs are those of the study: done once, in order, resumed after any stop. Throws InputError without a
// free parameter.
Identification identify(const StudyFile& file, const Priors& priors, study::StudyRuns& runs, const study::SceneReader& read_scene, Log& log);

} // namespace treacle::identify
