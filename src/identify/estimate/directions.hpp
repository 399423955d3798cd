#pragma once
#include "search/problem/search.hpp"
#include "search/rungs.hpp"

#include <Eigen/Dense>

#include <string>
#include <vector>

namespace treacle::identify {

// Points around an answer of several parameters that a local model needs beside those that there are: the answer itself, and a step
// along each direction in which no points near by lie. Within the bounds of the axes.
std::vector<search::Point> points_to_span(
    const Eigen::VectorXd& answer, const std::vector<Eigen::VectorXd>& points, const std::vector<search::Axis>& axes);

// An answer at one spacing.
struct ResolutionAnswer {
    double spacing = 0;    // [m]
    int runs = 1;          // that the answer is of
    Eigen::VectorXd value; // [p]
};

// Answers at spacing zero, [p] of the coordinates.
struct ResolvedAnswer {
    Eigen::VectorXd value;
    Eigen::MatrixXd resolution, noise;       // covariances
    std::vector<search::Extrapolation> axes; // [p] along the principal axes
};

// (I6) Extrapolates answers along the principal axes of their covariance, by which they are independent: parameters
// that trade with each other move together from rung to rung, and apart each would scatter widely. noise: covariance of
// the coarsest rung's answer by the numerical noise of one run, measured with `freedom` degrees of freedom: taken as a
// multiple of the fit's covariance, tr(covariance^-1 noise) / p, since a few runs span fewer directions than there are
// parameters. One parameter is itself.
ResolvedAnswer extrapolate_answers(const std::vector<ResolutionAnswer>& answers, const Eigen::MatrixXd& covariance,
    const Eigen::MatrixXd& noise, int freedom);

// Parameters that trade with each other, by the covariance of their coordinates: a sentence for each pair that does. Empty for one parameter.
std::vector<std::string> trades(const std::vector<std::string>& names, const Eigen::MatrixXd& covariance);

} // namespace treacle::identify
