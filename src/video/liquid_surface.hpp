#pragma once
#include "video/shading.hpp"

namespace treacle::video {

// A liquid's particles melted into one smooth surface, in the space of the picture: after van der Laan et al.
// 2009 (depths smoothed, thickness added up) with the narrow-range filter of Truong and Yuksel 2018.
struct LiquidSurface {
    int width = 0, height = 0;
    std::vector<float> depth; // [height][width] [m], far_away where there is no liquid
    std::vector<float> value; // [height][width] smoothed value of the nearest particles; empty without values
    std::vector<float> thickness; // [height][width] [m] of liquid behind each pixel
};

// `values`: one number per sphere, or empty.
LiquidSurface melt(const Camera& camera, std::span<const Sphere> particles, std::span<const float> values);

// The outward normal, camera axes.
Vec3f normal_at(const LiquidSurface& surface, const Camera& camera, int column, int row);

// Linear light of the surface: the liquid's own colour, the scene behind it (`behind`) as far as the liquid
// is thin, and the sky and the lamp mirrored. `clarity` [m]: the thickness at which 37 % come through; 0:
// none.
Vec3f shade_liquid(const Fragment& fragment, const Lamp& lamp, const Vec3f& behind, float thickness,
                   float clarity);

} // namespace treacle::video
