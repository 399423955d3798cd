#include "scene/surface.hpp"

#include "scene/vector_math.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::scene {
namespace {

constexpr int newton_steps = 20;
constexpr int bisection_steps = 30;
constexpr double depth_tolerance = 1e-4; // in spacings

} // namespace

std::int64_t count_intervals(double length, double spacing) {
    if (length <= 1e-6 * spacing) return 0;
    const auto rounded = std::max<std::int64_t>(1, std::llround(length / spacing));
    return length > 1.05 * spacing * static_cast<double>(rounded) ? rounded + 1 : rounded;
}

std::optional<Vec3> project(const Surface& surface, const Vec3& x, double inset, double spacing) {
    Vec3 p = x;
    for (int step = 0; step < newton_steps; ++step) {
        const Nearest near = surface.nearest(p);
        const double error = near.distance + inset;
        if (std::abs(error) < depth_tolerance * spacing) return p - error * near.normal;
        p = p - error * near.normal;
    }
    return std::nullopt;
}

Settled settle(const Surface& surface, const Vec3& c, const Vec3& n, double inset, double spacing) {
    if (inset == 0) return {c, false};
    if (const auto point = project(surface, c - inset * n, inset, spacing)) return {*point, false};
    // The largest depth to which c stays the closest surface point: there lies the medial axis.
    double reached = 0, beyond = 1;
    for (int step = 0; step < bisection_steps; ++step) {
        const double share = 0.5 * (reached + beyond), depth = share * inset;
        const double distance = -surface.nearest(c - depth * n).distance;
        (distance * inset > 0 && std::abs(distance) >= std::abs(depth) * (1 - 1e-6) ? reached : beyond) = share;
    }
    return {c - (reached * inset) * n, true};
}

} // namespace treacle::scene
