#pragma once
#include "identify/estimate/residual_blocks.hpp"

namespace treacle::identify {

// Drift of the answer over the frames of an experiment, of one parameter, by a linear model with a parameter for each of four windows that tell about as much, and the view of the
// experiment within its priors; weights are those of the fit to all. gradient: [rows] of the residuals by the parameter.
Drift drift_of(std::size_t experiment, const EvaluatedRun& run, const Layout& layout, const Fit& whole, const Vector& gradient, const Matrix& view, const Matrix& information,
               const std::vector<int>& blocks);

} // namespace treacle::identify
