#pragma once
#include "video/drawing/shading.hpp"

namespace treacle::video {

// Linear light of a liquid's surface: the liquid's own colour, the scene behind it (`behind`) as far as the liquid
// is thin, and the sky and the lamp mirrored. `thickness` [m] along the ray; `attenuation_length` [m]: the thickness at which 37 % come
// through; 0: none.
Vec3f shade_liquid(const Fragment& fragment, const DirectionalLight& lamp, const Vec3f& behind, float thickness,
    float attenuation_length);

} // namespace treacle::video
