#pragma once
#include "identify/estimate/estimate.hpp"
#include "identify/experiment/study_file.hpp"

#include <Eigen/Dense>

#include <optional>
#include <vector>

namespace treacle::identify {

// Information on the view before the films are compared, per experiment: one over the square of each deviation that the
// study states.
using Priors = std::vector<ViewInformation>;

// Information on the view of a film. pose: covariance of the calibrated pose (turns [rad], place [m]), in the place of the stated ones. focal_deviation: relative, that of the
// calibration where it is > 0.
ViewInformation information_of(
    const ViewUncertainty& uncertainty, const std::optional<Eigen::Matrix<double, 6, 6>>& pose, double focal_deviation);
ViewInformation sheet_information(const ViewUncertainty& uncertainty);
ViewInformation series_information(const ViewUncertainty& uncertainty, const Series& series);

} // namespace treacle::identify
