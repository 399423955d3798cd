#pragma once
#include "identify/estimate/residual_blocks.hpp"

namespace treacle::identify {

// Fit to all frames.
struct WholeFit {
    const EvaluatedRun& run;
    const Layout& layout;
    const Fit& fit;
    Vector gradient;    // [rows] of the residuals by the parameter
    const Matrix& view; // [rows][views' parameters]
    Matrix information; // on the views' parameters
    const std::vector<int>& blocks;
};

// Drift of the answer over the frames of an experiment, of one parameter, by a linear model with a parameter for each
// of four windows of about as much information, and the view of the experiment within its priors; weights are those of
// the fit to all.
Drift drift_of(std::size_t experiment, const WholeFit& all);

} // namespace treacle::identify
