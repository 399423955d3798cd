#include "rigid/contact_features.hpp"

#include <algorithm>

namespace treacle::rigid {

namespace {
constexpr double step = 2e-3;  // [spacings] how far directions are followed out of a surface
constexpr double askew = 2e-5; // of that step, what a direction out of the cone may lose: 6 mrad
constexpr double most_turning =
    0.3; // [rad] by which it may be out of it more, as the solids turn to each other in the step
constexpr double lift = 2 * step;     // [spacings] by which a probed point is out of the solid that it overlaps
constexpr double deepest = 0.1;       // [spacings] by which it is moved for that
constexpr double patch = 0.75;        // [spacings] about a sample that it stands for
constexpr double patch_margin = 0.25; // [spacings] by how much a point of it may be nearer to another solid, off edges
constexpr double still = 1e-7;        // [spacings]
constexpr int settlings = 16;
constexpr int bisections = 24;
constexpr double straight = 1e-4; // [spacings] that an edge may be off its tangent
} // namespace

// True when the normal is the same at x and at `length_beside` [m] from it.
bool Obstacle::flat(const Vec3& x, double length_beside) const {
    if (!solid_) return true;
    const Vec3 n = normal(x), t = any_perpendicular(n);
    for (const Vec3& across : {t, cross(n, t)}) {
        if (length(normal(x + length_beside * across) - n) > 1e-9) return false;
    }
    return true;
}

void NearestFeatures::set_turning(double angle) {
    askew_ = std::max(askew, 1 - std::cos(std::min(angle, most_turning)));
}

Touch NearestFeatures::measure(const Vec3& x) const { return {x, other_.normal(x), other_.distance(x)}; }

// True when x is the point of the probed solid nearest to what lies in this direction.
bool NearestFeatures::in_cone(const Vec3& x, const Vec3& direction) const {
    const double e = step * spacing_;
    const Vec3 out = x + e * direction;
    const double least = (1 - askew_) * e;
    if (probed_.distance(out) < least) return false;
    return !rests_ ||
           std::ranges::none_of(around_, [&](const PosedSolid* solid) { return solid->distance(out) < least; });
}

// True when a resting solid lies on the other surface at this point, so that nothing can reach it against the normal.
bool NearestFeatures::covered(const Vec3& foot, const Vec3& normal) const {
    const double e = step * spacing_;
    return std::ranges::any_of(around_, [&](const PosedSolid* solid) {
        return solid->distance(foot) < e && solid->distance(foot + e * normal) < (1 - askew) * e;
    });
}

// The touch from the position at which the point is out of all that it overlaps, moved into its own solid; nothing
// where others cover the surface.
std::optional<Touch> NearestFeatures::seen(Touch touch, const Vec3& inwards) const {
    const double least = lift * spacing_;
    const auto nearest = [&](const Vec3& x) {
        double distance = least;
        for (const auto* solid : around_) distance = std::min(distance, solid->distance(x));
        return distance;
    };
    if (around_.empty() || rests_) return touch;
    double moved = 0;
    const bool overlaps = nearest(touch.point) < least;
    for (int k = 0; overlaps && k < settlings; ++k) {
        const Vec3 x = touch.point + moved * inwards;
        const double distance = std::min(nearest(x), other_.distance(x));
        if (distance >= (1 - 1e-6) * least) break;
        moved += least - distance;
        if (moved > deepest * spacing_) return touch;
    }
    if (moved == 0) {
        if (covered(touch.point - touch.gap * touch.normal, touch.normal)) return {};
        return touch;
    }
    const Vec3 x = touch.point + moved * inwards, normal = other_.normal(x), foot = x - other_.distance(x) * normal;
    if (covered(foot, normal)) return {};
    return Touch{touch.point, normal, dot(touch.point - foot, normal)};
}

// The nearest point of the probed surface to the deepest ball within the other one that touches it where it is nearest to x; again
// from there, until x stays. A face on a face has no nearest point: x itself is as good.
std::optional<Vec3> NearestFeatures::settle(const Vec3& first, double size) const {
    Vec3 x = first;
    for (int k = 0; k < settlings; ++k) {
        const auto touch = measure(x);
        const Vec3 foot = x - touch.gap * touch.normal;
        double radius = 4 * size;
        if (!other_.flat(foot, 0.05 * spacing_)) {
            for (int h = 0; h < bisections && other_.distance(foot - radius * touch.normal) > -(1 - 1e-6) * radius; ++h)
                radius /= 2;
        }
        const Vec3 centre = foot - radius * touch.normal, n = probed_.normal(x);
        Vec3 next = centre - dot(centre - x, n) * n;
        const bool flat =
            std::abs(probed_.distance(next)) <= 1e-9 * spacing_ && length(probed_.normal(next) - n) < 1e-9;
        if (!flat) next = centre - probed_.distance(centre) * probed_.normal(centre);
        if (length(next - first) > patch * spacing_) break;
        if (length(next - x) < still * spacing_) {
            if (in_cone(next, -other_.normal(next))) return next;
            break;
        }
        if (flat && length(other_.normal(next) - touch.normal) < 1e-9) break;
        x = next;
    }
    if (in_cone(first, -other_.normal(first))) return first;
    return {};
}

// Contact point where the edge passes nearest to the other solid, with the normal across it: of two crossing edges, at right angles to both.
std::optional<Touch> NearestFeatures::along_edge(const Vec3& x, const Vec3& edge) const {
    const auto slope = [&](double s) { return dot(edge, other_.normal(x + s * edge)); };
    double low = -patch * spacing_, high = -low;
    if (slope(low) >= 0 || slope(high) <= 0) return {};
    for (int k = 0; k < bisections; ++k) {
        const double middle = 0.5 * (low + high);
        (slope(middle) < 0 ? low : high) = middle;
    }
    const Vec3 p = x + 0.5 * (low + high) * edge;
    if (std::abs(probed_.distance(p)) > straight * spacing_) return {};
    const Vec3 before = other_.normal(x + low * edge), after = other_.normal(x + high * edge);
    const double a = dot(after, edge), b = -dot(before, edge);
    Vec3 n = a * before + b * after;
    if (!(length(n) > 1e-6 * (a + b))) return {};
    n = (1 / length(n)) * n;
    const double distance = other_.distance(p);
    const double gap = distance < 0 ? distance / std::max(dot(n, before), dot(n, after)) : distance;
    return Touch{p, n, gap};
}

std::optional<Touch> NearestFeatures::at(const Vec3& x, const SurfacePoint& surface, const Near& near) const {
    const Vec3& edge = surface.edge;
    const bool edged = length(edge) > 0;
    if (other_.distance(x) > near.margin + (edged ? patch : patch_margin) * spacing_) return {};
    Touch touch;
    if (const auto settled = settle(x, near.size)) {
        touch = measure(*settled);
    } else {
        if (!edged) return {};
        const auto crossing = along_edge(x, edge);
        if (!crossing || !in_cone(crossing->point, -crossing->normal)) return {};
        touch = *crossing;
    }
    if (touch.gap >= near.margin) return {};
    return seen(touch, surface.inwards);
}

std::optional<Touch> NearestFeatures::of_ball(const Vec3& x, double radius, double margin) const {
    auto touch = measure(x);
    const Vec3 foot = x - touch.gap * touch.normal;
    touch.gap -= radius;
    touch.point = x - radius * touch.normal;
    if (touch.gap >= margin || covered(foot, touch.normal)) return {};
    return touch;
}

SurfacePoint describe_surface(const scene::SolidRegion& region, const Vec3& x, double spacing) {
    const double e = step * spacing;
    const Vec3 own = region.normal(x);
    if (region.distance(x - e * own) < -0.95 * e) return {{0, 0, 0}, -own};
    // The faces nearest to points inside, about x on a spiral without symmetries.
    constexpr int directions = 60;
    std::vector<Vec3> faces;
    for (int k = 0; k < directions; ++k) {
        const double height = 1 - (2 * k + 1.0) / directions, angle = 2.399963229728653 * k,
                     across = std::sqrt(1 - height * height);
        Vec3 way{across * std::cos(angle), across * std::sin(angle), height};
        if (region.dimensions() == 2) way = {std::cos(angle), std::sin(angle), 0};
        const Vec3 inside = x + e * way;
        if (region.distance(inside) > -0.05 * e) continue;
        const Vec3 n = region.normal(inside);
        if (std::ranges::none_of(faces, [&](const Vec3& other) { return dot(n, other) > 0.99; })) faces.push_back(n);
    }
    SurfacePoint out{{0, 0, 0}, -own};
    Vec3 sum{0, 0, 0};
    for (const auto& n : faces) sum = sum - n;
    if (length(sum) > 1e-3) out.inwards = (1 / length(sum)) * sum;
    if (region.dimensions() == 2 || faces.size() != 2) return out;
    const Vec3 t = cross(faces[0], faces[1]);
    if (length(t) > 1e-3) out.edge = (1 / length(t)) * t;
    return out;
}

} // namespace treacle::rigid
