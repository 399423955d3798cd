#pragma once
#include "video/drawing/splat.hpp"
#include "video/drawing/view.hpp"

#include <vector>

namespace treacle::video {

// Linear light per pixel before it is averaged and encoded.
struct Canvas {
    int width, height;
    std::vector<Vec3f> light; // [height][width]
};

// Index of the floor among a DepthBuffer's spheres.
constexpr std::int32_t floor_plane = -2;

// Adds the domain's floor (z = min) wherever nothing else is seen. Nothing from below, nor in 2D.
void add_floor(const Camera& camera, const DomainBox& box, DepthBuffer& buffer);

// Draws the edges of the domain as lines of the given width [pixels], hidden by what is nearer than they.
struct BoxLines {
    Vec3f colour;                    // linear
    float width = 2, opacity = 0.6f; // [pixels]; 0 to 1
};
void draw_box(
    const Camera& camera, const DomainBox& box, const std::vector<float>& depth, const BoxLines& lines, Canvas& canvas);

} // namespace treacle::video
