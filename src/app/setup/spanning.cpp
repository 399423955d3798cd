#include "app/setup/spanning.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {
constexpr double touching = 1e-6; // spacings between ends that meet

bool along(const Vec3& v, std::size_t axis) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (k != axis && v[k] != 0) return false;
    }
    return true;
}

// True for a shape of constant section along the axis.
bool is_straight(const scene::Shape& shape, std::size_t axis) {
    if (shape.inverted || shape.rotation_angle != 0) return false;
    return shape.kind == scene::ShapeKind::box || (shape.kind == scene::ShapeKind::cylinder && along(shape.axis, axis));
}
} // namespace

bool may_turn(const scene::Body& body, std::size_t axis, int dimensions) {
    const auto turns = [&](const scene::Keyframe& frame) {
        return frame.rotation_angle != 0 && !along(frame.rotation_axis, axis);
    };
    if (body.kind == scene::BodyKind::fixed) return false;
    if (!along(body.angular_velocity, axis) || std::ranges::any_of(body.keyframes, turns)) return true;
    if (body.kind != scene::BodyKind::dynamic) return false;
    for (std::size_t k = dimensions == 2 ? 2 : 0; k < 3; ++k) {
        if (k != axis && !body.locked[3 + k]) return true;
    }
    return false;
}

Axes spanned_axes(const scene::Body& body, const scene::SolidRegion& region, const scene::Domain& domain) {
    Axes out{};
    const auto bounds = region.bounds();
    for (std::size_t k = 0; k < static_cast<std::size_t>(domain.dimensions); ++k) {
        const double period = domain.max[k] - domain.min[k], length = bounds.max[k] - bounds.min[k];
        out[k] = domain.faces[2 * k].kind == scene::BoundaryKind::periodic &&
                 std::fabs(length - period) <= touching * domain.spacing && is_straight(body.shape, k) &&
                 !may_turn(body, k, domain.dimensions);
    }
    return out;
}

scene::Shape with_images(scene::Shape shape, const Axes& spans, const scene::Domain& domain, double inset) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (!spans[k]) continue;
        const double more = domain.max[k] - domain.min[k] + inset;
        if (shape.kind == scene::ShapeKind::cylinder) shape.height += 2 * more;
        shape.min[k] -= more;
        shape.max[k] += more;
    }
    return shape;
}

double periodic_spacing(double d, const Axes& spans, const Vec3& min, const Vec3& max) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (spans[k]) return (max[k] - min[k]) / std::max(1.0, std::round((max[k] - min[k]) / d));
    }
    return d;
}

} // namespace treacle::app
