#pragma once
#include "identify/estimate/estimate.hpp"

namespace treacle::identify {

// (D1) Information [p][p] that an experiment would give of the parameters' coordinates, from a run at the answer and one a
// parameter, all compared with the same contours, beside a view that is known by its prior alone. variance: of a segment that counts as
// one, in units of the usual noise squared. Throws InputError where the runs have nothing in common to compare.
Eigen::MatrixXd information_of_runs(const RunResiduals& base, const std::vector<RunResiduals>& moved,
    const std::vector<double>& steps, const ViewInformation& prior, double variance);

// Variance of a segment of an answer's residuals, noise and correlation together, in units of the usual noise squared: the mean over its
// experiments.
double segment_variance(const Estimate& estimate, const std::vector<ExperimentKind>& kinds);

// (D2) (C^-1 + I)^-1: information adds up.
Eigen::MatrixXd covariance_after(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& information);

// (D3) half the width of the 90 % band of ln eta, root mean square over shear rates: slopes [rates][p] of ln eta by the coordinates.
double band_half_width(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& slopes);

} // namespace treacle::identify
