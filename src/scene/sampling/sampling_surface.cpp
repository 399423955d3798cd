#include "scene/sampling/sampling.hpp"
#include "scene/sampling/surface.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::scene {
namespace {

bool contains(const Bounds& box, const Vec3& x) {
    for (int a = 0; a < 3; ++a)
        if (x[a] < box.min[a] || x[a] > box.max[a]) return false;
    return true;
}

} // namespace

SurfaceSamples sample_surface(const SolidRegion& region, const SurfaceSampling& sampling) {
    SurfaceSampling inwards = sampling;
    if (region.inverted()) inwards.inset = -sampling.inset;
    SurfaceSamples result = region.surface().sample(inwards);
    Bounds clip = sampling.clip;
    if (region.dimensions() == 2) clip.min[2] = -Bounds::infinite, clip.max[2] = Bounds::infinite;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < result.positions.size(); ++i) {
        if (!contains(clip, result.positions[i])) continue;
        result.positions[kept] = result.positions[i];
        result.normals[kept] = region.inverted() ? -result.normals[i] : result.normals[i];
        ++kept;
    }
    result.positions.resize(kept);
    result.normals.resize(kept);
    result.thin = std::min(result.thin, kept);
    return result;
}

std::uint64_t estimate_surface_count(const SolidRegion& region, const SurfaceSampling& sampling) {
    const double d = sampling.spacing;
    const bool plane_scene = region.dimensions() == 2;
    double area = region.area();
    if (!std::isfinite(area)) { // a plane: no larger than the largest section of the clip
        const Vec3 e = sampling.clip.max - sampling.clip.min;
        area =
            plane_scene ? std::hypot(e[0], e[1]) : std::sqrt(3.0) * std::max({e[0] * e[1], e[1] * e[2], e[2] * e[0]});
    }
    if (region.inverted()) { // the layer lies outside the surface
        const Bounds b = region.surface_bounds();
        const double longest = std::max({b.max[0] - b.min[0], b.max[1] - b.min[1], b.max[2] - b.min[2]});
        const double growth = 1 + 2 * std::max(0.0, sampling.inset) / longest;
        area *= plane_scene ? growth : growth * growth;
    }
    // At most about 1.35 points per d^2, and a few more for edges.
    const double count = plane_scene ? 1.1 * area / d + 8 : 1.35 * area / (d * d) + 4 * std::sqrt(area) / d + 32;
    return static_cast<std::uint64_t>(std::min(count, 4e18));
}

} // namespace treacle::scene
