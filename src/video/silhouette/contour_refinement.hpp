#pragma once
#include "video/mask/mask.hpp"
#include "video/picture/image.hpp"
#include "video/silhouette/silhouette_settings.hpp"

#include <vector>

namespace treacle::video {

// Parts of a blurred contour, near it.
struct RefinedContour {
    Mask mask;
    double edge_width = 0; // standard deviation of the blur across the contour [px]; 0: not measured
    double faint = 0;      // liquid less than a third as clear of the background as the clearest half [px]
    double contrast = 0;   // median distance of liquid and background at the contour, of 1
};

// Moves the contour of `rough` to where half of a pixel is liquid. A camera's blurred pixel is I = a F + (1 - a) B in
// light, with the share a of the liquid, its light F and the background's B. F and B are means over pixels near by that
// the blur leaves alone, weighted by their distance to the contour (normalised convolution: Knutsson & Westin 1993); B has
// the pattern of the empty scene where `background` [height][width][3], of 255, is given. Then
// a = dot(I - B, F - B) / |F - B|^2, and the contour is at a = 1/2: for any blur that is even, a straight edge's true place,
// and sigma^2 / (2 R) inside that of a disc of radius R. A fixed grey level instead is off by sigma times the quantile of
// its share. `edge_width` as measured in frames before, 0 at first [px].
RefinedContour refine_contour(
    const Image& frame, const std::vector<float>& background, const Mask& rough, MixingSpace mixing, double edge_width);

// Deviation of a frame's blurred contours from even, in light and in the numbers of the file: root mean square of the
// even part of the mean profile along the contour's normals. Both 0 where the contour is too short.
struct Unevenness {
    double light = 0, code = 0; // root mean squares in the share of liquid, 0 to 1
};
Unevenness measure_unevenness(const Image& frame, const std::vector<float>& background, const Mask& rough);

} // namespace treacle::video
