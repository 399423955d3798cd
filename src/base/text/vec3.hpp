#pragma once
#include <array>

namespace treacle {

// A point or vector of the host side, [m] unless said otherwise. In 2D scenes the third component is zero.
using Vec3 = std::array<double, 3>;

} // namespace treacle
