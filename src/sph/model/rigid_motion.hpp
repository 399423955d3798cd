#pragma once
#include "base/text/vec3.hpp"

namespace treacle::sph {

// Velocity at x of a rigid motion: of unit speed along axis k for k < 3, of unit spin about axis k - 3 otherwise.
inline Vec3 rigid_motion(int k, const Vec3& x) {
    Vec3 out{0, 0, 0};
    if (k < 3) {
        out[static_cast<std::size_t>(k)] = 1;
        return out;
    }
    const std::size_t e = static_cast<std::size_t>(k - 3), p = (e + 1) % 3, q = (e + 2) % 3;
    out[p] = -x[q];
    out[q] = x[p];
    return out;
}

} // namespace treacle::sph
