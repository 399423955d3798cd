#pragma once
#include "app/identify/curve_run.hpp"

#include <functional>

namespace treacle::app {

// Derivatives of ln eta at shear rates [1/s] by the coordinates of the searched parameters, [rates][p], at an answer in the parameters'
// units. Throws InputError.
Eigen::MatrixXd flow_curve_slopes(const identify::StudyFile& file, const std::vector<double>& answer,
    const std::string& liquid, const std::vector<double>& rates);

// Flow curves of the liquids of which keys were identified, by the study's first scene that has them. The band is that of the parameters'
// covariance, linear in the logarithm of the viscosity; shear rates are those of the runs at the best trial, which lie in the
// folders that `folder_of` returns. `measured`: by a rheometer. Throws InputError.
std::vector<identify::FlowCurveBand> flow_curve_bands(const identify::StudyFile& file,
    const identify::Identification& identification, const std::function<std::filesystem::path(std::int64_t)>& folder_of,
    const std::optional<MeasuredCurve>& measured);

} // namespace treacle::app
