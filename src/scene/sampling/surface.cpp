#include "scene/sampling/surface.hpp"

#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::scene {
namespace {

constexpr int newton_steps = 20;
constexpr double depth_tolerance = 1e-4; // in spacings

// Thickness of the body (inset < 0: of the space around it) behind the surface point c, along the normal, as far as
// twice the inset: by sphere tracing. A surface that runs along the ray, beside an edge, is no end.
double measure_thickness(const Surface& surface, const Vec3& c, const Vec3& n, double inset) {
    const double limit = 2 * std::abs(inset), side = std::copysign(1.0, inset);
    const double resolution = 1e-3 * std::abs(inset), least_step = 0.02 * std::abs(inset);
    constexpr double facing = 0.3; // cosine
    double t = 0.05 * std::abs(inset);
    while (t < limit) {
        const Nearest near = surface.nearest(c - side * t * n);
        const double depth = -side * near.distance;
        if (depth < resolution && dot(near.normal, n) < -facing) return t + depth;
        t += std::max(depth, least_step);
    }
    return limit;
}

} // namespace

std::int64_t count_intervals(double length, double spacing) {
    if (length <= 1e-6 * spacing) return 0;
    const auto rounded = std::max<std::int64_t>(1, std::llround(length / spacing));
    return length > 1.05 * spacing * static_cast<double>(rounded) ? rounded + 1 : rounded;
}

std::optional<Vec3> project(const Surface& surface, const Vec3& x, double inset, double tolerance) {
    Vec3 p = x;
    for (int step = 0; step < newton_steps; ++step) {
        const Nearest near = surface.nearest(p);
        const double error = near.distance + inset;
        if (std::abs(error) < tolerance) return p - error * near.normal;
        p = p - error * near.normal;
    }
    return std::nullopt;
}

std::optional<InsetPoint> project_to_inset(
    const Surface& surface, const Vec3& c, const Vec3& n, double inset, double spacing) {
    if (inset == 0) return InsetPoint{c, false};
    if (const double thickness = measure_thickness(surface, c, n, inset); thickness < 2 * std::abs(inset))
        return InsetPoint{c - std::copysign(0.5 * thickness, inset) * n, true};
    if (const auto point = project(surface, c - inset * n, inset, depth_tolerance * spacing))
        return InsetPoint{*point, false};
    return std::nullopt;
}

} // namespace treacle::scene
