#include "rigid/contact_features.hpp"

#include <algorithm>

namespace treacle::rigid {

namespace {
constexpr double step = 2e-3;       // [spacings] how far directions are followed out of a surface
constexpr double askew = 2e-5;      // of that step, what a direction out of the cone may lose: 6 mrad
constexpr double lift = 2 * step;   // [spacings] that a point is moved out of what it overlaps before it is looked at
constexpr double deepest = 0.1;     // [spacings] of such an overlap
constexpr double patch = 0.75;      // [spacings] about a sample that it stands for
constexpr int settlings = 12;
constexpr int halvings = 24;

Vec3 any_across(const Vec3& n) {
    const Vec3 t = std::abs(n[2]) < 0.9 ? Vec3{-n[1], n[0], 0} : Vec3{n[2], 0, -n[0]};
    return (1 / length(t)) * t;
}
} // namespace

// Whether the normal is the same a length beside x.
bool Obstacle::flat(const Vec3& x, double length_beside) const {
    if (!solid_) return true;
    const Vec3 n = normal(x), t = any_across(n);
    for (const Vec3& across : {t, cross(n, t)}) {
        if (length(normal(x + length_beside * across) - n) > 1e-9) return false;
    }
    return true;
}

Touch NearestFeatures::measure(const Vec3& x) const { return {x, other_.normal(x), other_.distance(x)}; }

// Whether nothing of the probed solid is nearer to what lies in this direction than x is.
bool NearestFeatures::in_cone(const Vec3& x, const Vec3& direction) const {
    const double e = step * spacing_;
    const Vec3 out = x + e * direction;
    if (probed_.distance(out) < (1 - askew) * e) return false;
    return !rests_ || std::ranges::none_of(around_, [&](const PlacedSolid* solid) {
        return solid->distance(out) < (1 - askew) * e;
    });
}

// Whether what rests is in the way of anything that comes to the point of the other surface against the normal.
bool NearestFeatures::covered(const Vec3& foot, const Vec3& normal) const {
    const double e = step * spacing_;
    return std::ranges::any_of(around_, [&](const PlacedSolid* solid) {
        return solid->distance(foot) < e && solid->distance(foot + e * normal) < (1 - askew) * e;
    });
}

// The touch as it is when the point has been moved out of other solids that rest; nothing where they cover the surface.
std::optional<Touch> NearestFeatures::seen(Touch touch) const {
    if (around_.empty()) return touch;
    const double least = lift * spacing_;
    Vec3 x = touch.point;
    bool moved = false;
    for (const auto* solid : around_) {
        const double overlap = least - solid->distance(x);
        if (overlap <= 0 || overlap > deepest * spacing_) continue;
        x = x + overlap * solid->normal(x);
        moved = true;
    }
    const double gap = moved ? other_.distance(x) : touch.gap;
    const Vec3 normal = moved ? other_.normal(x) : touch.normal, foot = x - gap * normal;
    if (covered(foot, normal)) return {};
    if (moved && dot(normal, touch.normal) < 1 - askew) touch = {touch.point, normal, dot(touch.point - foot, normal)};
    return touch;
}

// The nearest point of the probed surface near x to a ball within the other one that touches it where x is nearest.
std::optional<Vec3> NearestFeatures::settle(Vec3 x, double size) const {
    const Vec3 first = x;
    for (int k = 0; k < settlings; ++k) {
        const auto touch = measure(x);
        if (in_cone(x, -touch.normal)) return x;
        const Vec3 foot = x - touch.gap * touch.normal;
        double radius = 4 * size;
        if (!other_.flat(foot, 0.05 * spacing_)) {
            for (int h = 0; h < halvings && other_.distance(foot - radius * touch.normal) > -(1 - 1e-6) * radius; ++h) radius /= 2;
        }
        const Vec3 centre = foot - radius * touch.normal, n = probed_.normal(x);
        Vec3 next = centre - dot(centre - x, n) * n;
        if (std::abs(probed_.distance(next)) > 1e-9 * spacing_) next = centre - probed_.distance(centre) * probed_.normal(centre);
        if (length(next - first) > patch * spacing_ || length(next - x) < 1e-12 * spacing_) return {};
        x = next;
    }
    return {};
}

// Where the edge passes the other solid nearest, and the normal across it: of two edges that cross that of both.
std::optional<Touch> NearestFeatures::along_edge(const Vec3& x, const Vec3& edge) const {
    const auto slope = [&](double s) { return dot(edge, other_.normal(x + s * edge)); };
    double low = -patch * spacing_, high = -low;
    if (slope(low) >= 0 || slope(high) <= 0) return {};
    for (int k = 0; k < halvings; ++k) {
        const double middle = 0.5 * (low + high);
        (slope(middle) < 0 ? low : high) = middle;
    }
    const Vec3 p = x + 0.5 * (low + high) * edge;
    const Vec3 before = other_.normal(x + low * edge), after = other_.normal(x + high * edge);
    const double a = dot(after, edge), b = -dot(before, edge);
    Vec3 n = a * before + b * after;
    if (!(length(n) > 1e-6 * (a + b))) return {};
    n = (1 / length(n)) * n;
    const double distance = other_.distance(p);
    const double gap = distance < 0 ? distance / std::max(dot(n, before), dot(n, after)) : distance;
    return Touch{p, n, gap};
}

std::optional<Touch> NearestFeatures::at(const Vec3& x, const Vec3& edge, const Near& near) const {
    auto touch = measure(x);
    if (touch.gap > near.margin + patch_margin * spacing_) return {};
    if (!in_cone(x, -touch.normal)) {
        if (const auto settled = settle(x, near.size)) {
            touch = measure(*settled);
        } else {
            if (length(edge) == 0) return {};
            const auto crossing = along_edge(x, edge);
            if (!crossing || !in_cone(crossing->point, -crossing->normal)) return {};
            touch = *crossing;
        }
    }
    if (touch.gap >= near.margin) return {};
    return seen(touch);
}

std::optional<Touch> NearestFeatures::of_ball(const Vec3& x, double radius, double margin) const {
    auto touch = measure(x);
    const Vec3 foot = x - touch.gap * touch.normal;
    touch.gap -= radius;
    touch.point = x - radius * touch.normal;
    if (touch.gap >= margin || covered(foot, touch.normal)) return {};
    return touch;
}

Vec3 edge_tangent(const scene::SolidRegion& region, const Vec3& x, double spacing) {
    const double e = step * spacing;
    const Vec3 none{0, 0, 0};
    if (region.dimensions() == 2 || region.distance(x - e * region.normal(x)) < -0.95 * e) return none;
    // The faces nearest to points inside.
    std::vector<Vec3> faces;
    for (int k = 0; k < 27; ++k) {
        const Vec3 way{double(k % 3 - 1), double(k / 3 % 3 - 1), double(k / 9 - 1)};
        const Vec3 inside = x + e * way;
        if (k == 13 || region.distance(inside) > -0.05 * e) continue;
        const Vec3 n = region.normal(inside);
        if (std::ranges::none_of(faces, [&](const Vec3& other) { return dot(n, other) > 0.99; })) faces.push_back(n);
    }
    if (faces.size() != 2) return none;
    const Vec3 t = cross(faces[0], faces[1]);
    return length(t) > 1e-3 ? (1 / length(t)) * t : none;
}

} // namespace treacle::rigid
