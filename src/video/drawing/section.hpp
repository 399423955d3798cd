#pragma once
#include "video/drawing/liquid_view.hpp"

#include <functional>
#include <vector>

namespace treacle::video {

// Depth [m] of a plane at each pixel whose point of the plane lies in a solid, far_away elsewhere: [height][width].
// `distance`: signed from the solid's surface [m], negative inside, never larger than the true one.
std::vector<float> draw_section(
    const Camera& camera, const CutPlane& cut, const std::function<double(const Vec3&)>& distance);

} // namespace treacle::video
