#include "surface/field/solids.hpp"

#include <algorithm>

namespace treacle::surface {

Vec3 Solid::to_start(const Vec3& x) const {
    Vec3 from{}, out = centre;
    for (std::size_t k = 0; k < 3; ++k) from[k] = x[k] - centre[k] - translation[k];
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t l = 0; l < 3; ++l) out[k] += rotation[l][k] * from[l];
    }
    return out;
}

Vec3 Solid::to_present(const Vec3& x0) const {
    Vec3 out{};
    for (std::size_t k = 0; k < 3; ++k) {
        out[k] = centre[k] + translation[k];
        for (std::size_t l = 0; l < 3; ++l) out[k] += rotation[k][l] * (x0[l] - centre[l]);
    }
    return out;
}

double Solid::distance(const Vec3& x) const { return region.distance(to_start(x)); }

Vec3 Solid::normal(const Vec3& x) const {
    const Vec3 n = region.normal(to_start(x));
    Vec3 out{};
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t l = 0; l < 3; ++l) out[k] += rotation[k][l] * n[l];
    }
    return out;
}

double Solids::distance(const Vec3& x) const {
    double nearest = 1e300;
    for (const auto& body : bodies) nearest = std::min(nearest, body.distance(x));
    return nearest;
}

} // namespace treacle::surface
