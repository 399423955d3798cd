#pragma once
#include "scene/camera/camera_model.hpp"
#include "video/mask/mask.hpp"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace treacle::video {

// A silhouette with the name of its picture, for messages.
struct Silhouette {
    std::string name;
    Mask mask;
};

// From a picture of two tones: the tone that is rarer along the rim of the picture is the silhouette. InputError for a
// file that is no picture, and for one whose silhouette is empty.
Silhouette read_silhouette(const std::filesystem::path& path);

// A point of a silhouette's outline, to sub-pixel accuracy.
struct ContourPoint {
    scene::Vec2 pixel;
    scene::Vec2 normal; // unit, outward
    int piece = 0;      // outlines are numbered; points of one follow each other, about a pixel apart
};

// Options of find_contour.
struct ContourOptions {
    double blur = 1.5; // [pixels] of the Gaussian whose half level is the outline; pixels leave no steps then
    double sharpest =
        40; // [deg] turn of the normal over 8 pixels above which a point is left out as a corner, which the blur rounds
    double least_part = 0.02; // outlines around less area than this fraction of the largest are specks
};

// The outlines but for corners and for 3 pixels along the rim of the picture.
std::vector<ContourPoint> find_contour(const Mask& mask, const ContourOptions& options = {});

// Intersection over union.
double overlap(const Mask& a, const Mask& b);

} // namespace treacle::video
