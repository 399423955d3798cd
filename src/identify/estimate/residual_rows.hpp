#pragma once
#include "identify/estimate/estimate.hpp"

namespace treacle::identify {

// Dense vectors and matrices of the fit, by rows of a layout or by parameters.
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

// Segments of all experiments in one list, the rows of a fit.
struct Layout {
    struct Row {
        std::size_t experiment, segment; // index in EvaluatedRun::experiments, index in RunResiduals::segments
        double usual;                    // noise
    };
    std::vector<Row> rows;       // experiment by experiment, in the order of the segments
    std::size_t experiments = 0; // of the runs, with and without rows [count]
};

// Segments that stand in every run and that `run` compares.
Layout layout_of(const EvaluatedRun& run, const std::vector<EvaluatedRun>& others,
    const std::vector<std::vector<EvaluatedRun>>& finer);

// Residual of a row in a run of the layout.
inline const SegmentResidual& at(const EvaluatedRun& run, const Layout::Row& row) {
    return run.experiments[row.experiment].segments[row.segment];
}

// Residuals [rows], in units of their usual noise.
Vector displacements(const EvaluatedRun& run, const Layout& layout);
// Points of each segment over their mean in its experiment, [rows].
Vector sizes(const EvaluatedRun& run, const Layout& layout);
// Derivatives by the view's parameters of all experiments, [rows][experiments * view_count].
Matrix view_matrix(const EvaluatedRun& run, const Layout& layout);
// Information on parameters, of which there are `before` without any, and the views of all experiments.
Matrix prior_matrix(const std::vector<ViewInformation>& priors, Eigen::Index before);

} // namespace treacle::identify
