#pragma once
#include "identify/experiment/experiment.hpp"
#include "video/mask/contour.hpp"

#include <filesystem>

namespace treacle::identify {

// A mask of a film that is compared, by its time in the scene.
struct ObservedFrame {
    int number = 0;  // of the mask in its folder
    double time = 0; // [s] of the scene
    std::filesystem::path mask;
};

// Indices of the times that an experiment compares: those between `from` and `to` of the scene, every so many of them. `times` [s] by the
// observations' clock, in order. Throws InputError where none is left; `what`: "mask".
std::vector<std::size_t> compared_times(
    const Experiment& experiment, const std::vector<double>& times, const std::string& what);

// The masks of an experiment whose times lie between `from` and `to`, every so many of them. Times stand in the folder's
// silhouettes.csv or film.csv. Throws InputError where a mask is missing, or none is left.
std::vector<ObservedFrame> observed_frames(const Experiment& experiment, const std::filesystem::path& folder);

inline constexpr double segment_length = 25; // [px]

// A part of a contour of a mask of about that length: longer than the noise of a contour is correlated along it.
struct ContourSegment {
    std::vector<video::ContourPoint> points;
};
// Segments of contours without corners, excluded pixels and the rim of the picture, by pieces.
std::vector<ContourSegment> contour_segments(const video::Mask& mask, double length = segment_length);

} // namespace treacle::identify
