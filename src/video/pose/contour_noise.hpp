#pragma once
// Private to src/video: a linear fit of six parameters to displacements whose errors are correlated along an outline.
#include "video/mask/contour.hpp"
#include "video/pose/pose_algebra.hpp"

#include <vector>

namespace treacle::video {

// d_i + J_i x = error, at points of an outline.
struct OutlineEquation {
    double displacement = 0;    // [pixels]
    cv::Matx<double, 1, 6> row; // J
    scene::Vec2 pixel{0, 0}, normal{0, 0};
};

// Result of fit_outline.
struct OutlineFit {
    PoseVector change = PoseVector::all(0); // x: rotation [rad], translation [m]
    PoseMatrix covariance;                  // of the change, prior included
    double deviation = 0;                   // [pixels] of the errors
    double correlation = 0;                 // [pixels] length L
    double pieces = 0;                      // number of independent pieces that the outline counts as
};

// Generalised least squares with errors that are correlated along the outline, and of which a part is shared by the points
// of a straight edge, as by steps of pixels that run along it: covariance s^2 C,
//   C_ij = 0.1 delta_ij + 0.9 ((1 - g) exp(-(d/L)^m) + g exp(-|n_i - n_j|^2 / 0.2^2 - (d / 400)^2)),  d = |p_i - p_j|, m = 1 or 2;
// s, L, g and m by restricted likelihood (Patterson & Thompson 1971), which allows for what the fit takes out of the
// residuals. L, g and m are averaged over a grid by their likelihood, so that the covariance of the change counts that they
// are not known; 0.15 pixel that an edge shares is added, as the fit takes it up. `prior` is the information on x, of mean `mean`.
OutlineFit fit_outline(const std::vector<OutlineEquation>& all, const PoseMatrix& prior, const PoseVector& mean);

} // namespace treacle::video
