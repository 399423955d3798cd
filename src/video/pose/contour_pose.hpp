#pragma once
#include "video/pose/pose.hpp"
#include "video/pose/solid_view.hpp"

namespace treacle::video {

// Range of the search, and deviations of the start.
struct ContourPoseOptions {
    double search = 60;    // [pixels] from the outline within which the solid's outline is searched at first
    double angle = 0.0524; // [rad] 3 degrees: deviation of the start about each axis, where its covariance is not known
    double shift = 0.03;   // [m] of the start along each axis, likewise
};

// Result of refine_on_contour.
struct ContourPose {
    PoseEstimate estimate; // `noise`: [pixels] deviation of the signed displacements
    double mean = 0; // [pixels] signed displacement that is left, the solid's outline outside of the picture's: > 0
    double correlation = 0;                       // [pixels] over which displacements are alike
    double pieces = 0;                            // number of independent pieces that the outline counts as
    double fitting = 0;                           // fraction of the outline that the solid explains
    double overlap_before = 0, overlap_after = 0; // intersection over union of both silhouettes
    std::size_t points = 0;                       // of the silhouette's outline [count]
};

// Refines a pose such that the outline of a solid, projected, meets that of a silhouette: iterated closest points along
// the normals of the silhouette's outline, within a search that narrows, each round a Gauss-Newton step in signed
// displacements with Tukey's weights and the start's covariance as a prior. The last rounds and the covariance take the
// errors as correlated along the outline, over a length that follows from the residuals (contour_noise.hpp): it counts as
// independent pieces, never as independent pixels. The covariance of the lens counts as well.
//
// InputError for a silhouette of another size than the camera's pictures, and where less than a fifth of the outline
// matches the solid's.
ContourPose refine_on_contour(
    const CameraRecord& given, const SeenSolid& solid, const Silhouette& silhouette, const ContourPoseOptions& options);

} // namespace treacle::video
