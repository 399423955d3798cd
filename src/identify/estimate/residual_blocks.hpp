#pragma once
#include "identify/estimate/robust_fit.hpp"

namespace treacle::identify {

// Frames until the displacements left over are no more correlated: from those of segments at like places in the picture.
int correlation_frames(
    const EvaluatedRun& run, const Layout& layout, const Vector& left, const std::vector<int>& sector);
// Sixths of the picture around the middle of a frame's contour: parts that share no noise. One where frames are averages.
std::vector<int> sectors(const EvaluatedRun& run, const Layout& layout);
// Block of each row: neighbouring frames, a sector.
std::vector<int> blocks_of(
    const EvaluatedRun& run, const Layout& layout, const std::vector<int>& sector, int frames_each);
// A fit, the gradient [rows][parameters] of its model, and the block of each row.
struct BlockedFit {
    const Fit& fit;
    const Matrix& g;                // [rows][parameters]
    const std::vector<int>& blocks; // [rows]
};
// (I4) Change of the parameters by leaving out each block, [blocks][parameters]: (A - A_b)^-1 G_b^T W_b r_b.
Matrix block_changes(const BlockedFit& blocked, const Matrix& information);
// Variance of the parameters by the blocks of each experiment over that by its independent segments, the largest, at least 1.
std::vector<double> inflation(const BlockedFit& blocked, const Matrix& changes, const Layout& layout, Eigen::Index p);

} // namespace treacle::identify
