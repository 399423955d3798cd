#pragma once
// Private to src/video.
#include "video/camera/calibration.hpp"

namespace treacle::video {

// Covariance of the intrinsic parameters at the optimum over the pictures used; see calibrate().
IntrinsicCovariance jackknife_covariance(const Calibration& calibration);

// Covariance of independent errors of equal size, sigma^2 (J^T J)^-1 with the poses eliminated: OpenCV's.
IntrinsicCovariance independent_covariance(const Calibration& calibration);

} // namespace treacle::video
