// Bodies of revolution, and their cuts by a plane through the axis.
#include "scene/sampling/poisson_disk_layer.hpp"
#include "scene/sampling/surface.hpp"
#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace treacle::scene {
namespace {

constexpr double pi = std::numbers::pi;

// In the half-plane of a profile: r from the axis, h along it.
struct Point2 {
    double r = 0, h = 0;
};
Point2 difference(Point2 a, Point2 b) { return {a.r - b.r, a.h - b.h}; }

struct Nearest2 {
    double distance = 0;
    Point2 normal;
};

Nearest2 from_circle(Point2 p, Point2 centre, double radius) {
    const Point2 gap = difference(p, centre);
    const double l = std::hypot(gap.r, gap.h);
    return {l - radius, l > 0 ? Point2{gap.r / l, gap.h / l} : Point2{0, 1}};
}

Nearest2 from_cylinder(Point2 p, double radius, double half) {
    const double side = p.r - radius, cap = std::abs(p.h) - half, up = p.h < 0 ? -1 : 1;
    if (side > 0 && cap > 0) {
        const double l = std::hypot(side, cap);
        return {l, {side / l, up * cap / l}};
    }
    return side > cap ? Nearest2{side, {1, 0}} : Nearest2{cap, {0, up}};
}

Nearest2 from_cone(Point2 p, double radius, double half) {
    const bool inside = p.h > -half && p.r * 2 * half < radius * (half - p.h);
    const Point2 on_base{std::min(p.r, radius), -half};
    const double slant2 = radius * radius + 4 * half * half;
    const double s = std::clamp(((p.r - radius) * -radius + (p.h + half) * 2 * half) / slant2, 0.0, 1.0);
    const Point2 on_side{radius * (1 - s), -half + 2 * half * s};
    const Point2 to_base = difference(p, on_base), to_side = difference(p, on_side);
    const double base = std::hypot(to_base.r, to_base.h), side = std::hypot(to_side.r, to_side.h);
    const bool base_nearer = base < side;
    const double distance = base_nearer ? base : side, sign = inside ? -1 : 1;
    if (distance == 0) {
        const double slant = std::sqrt(slant2);
        return {0, base_nearer ? Point2{0, -1} : Point2{2 * half / slant, radius / slant}};
    }
    const Point2 gap = base_nearer ? to_base : to_side;
    return {sign * distance, {sign * gap.r / distance, sign * gap.h / distance}};
}

struct Station {
    Point2 at, normal;
};

// Points along a profile: pieces that follow each other share their corners, whose normals are added.
class Walk {
public:
    explicit Walk(double spacing) : spacing_(spacing) {}

    void line(Point2 from, Point2 to) {
        const Point2 along = difference(to, from);
        const double l = std::hypot(along.r, along.h);
        const auto n = count_intervals(l, spacing_);
        if (n == 0) return add({from, {0, 0}});
        const Point2 normal{along.h / l, -along.r / l}; // profiles run upwards with the axis to the left
        for (std::int64_t i = 0; i <= n; ++i) {
            const double s = static_cast<double>(i) / static_cast<double>(n);
            add({i == n ? to : Point2{from.r + s * along.r, from.h + s * along.h}, normal});
        }
    }

    void arc(Point2 centre, double radius, double from, double to) {
        const auto n = count_intervals(radius * std::abs(to - from), spacing_);
        for (std::int64_t i = 0; i <= n; ++i) {
            const double angle = n == 0 ? from : from + (to - from) * static_cast<double>(i) / static_cast<double>(n);
            const double c = std::cos(angle), s = std::sin(angle);
            add({{std::max(0.0, centre.r + radius * c), centre.h + radius * s}, {c, s}});
        }
    }

    std::vector<Station> stations;

private:
    void add(const Station& s) {
        if (!stations.empty()) {
            Station& last = stations.back();
            const Point2 gap = difference(s.at, last.at);
            if (std::hypot(gap.r, gap.h) < 1e-9 * spacing_) {
                last.normal = {last.normal.r + s.normal.r, last.normal.h + s.normal.h};
                return;
            }
        }
        stations.push_back(s);
    }

    double spacing_;
};

class Round : public Surface {
public:
    explicit Round(const SurfaceOfRevolution& body) : body_(body), side_(perpendicular(body.axis)) {}

    Nearest nearest(const Vec3& x) const override {
        const Vec3 gap = x - body_.centre;
        const double h = dot(gap, body_.axis);
        const Vec3 out = gap - h * body_.axis;
        const double r = length(out);
        const Nearest2 n = nearest_profile({r, h});
        const Vec3 direction = r > 0 ? (1 / r) * out : side_;
        return {n.distance, unit(n.normal.r * direction + n.normal.h * body_.axis, body_.axis)};
    }

    Bounds bounds() const override {
        Bounds box;
        for (int a = 0; a < 3; ++a) {
            const double along = std::abs(body_.axis[a]);
            const double across = std::sqrt(std::max(0.0, 1 - along * along));
            const double half = 0.5 * body_.height * along, disc = body_.radius * across;
            double low = 0, high = 0;
            switch (body_.profile) {
            case Profile::sphere: low = high = body_.radius; break;
            case Profile::cylinder: low = high = half + disc; break;
            case Profile::capsule: low = high = half + body_.radius; break;
            case Profile::torus: low = high = disc + body_.tube; break;
            case Profile::cone: {
                const double apex = 0.5 * body_.height * body_.axis[a];
                low = -std::min(-apex - disc, apex);
                high = std::max(-apex + disc, apex);
            }
            }
            box.min[a] = body_.centre[a] - low;
            box.max[a] = body_.centre[a] + high;
        }
        return box;
    }

    double volume() const override {
        const double r = body_.radius, h = body_.height, t = body_.tube;
        switch (body_.profile) {
        case Profile::sphere: return 4 * pi / 3 * r * r * r;
        case Profile::cylinder: return pi * r * r * h;
        case Profile::capsule: return pi * r * r * (h + 4 * r / 3);
        case Profile::cone: return pi * r * r * h / 3;
        case Profile::torus: return 2 * pi * pi * r * t * t;
        }
        return 0;
    }

    double area() const override {
        const double r = body_.radius, h = body_.height, t = body_.tube;
        switch (body_.profile) {
        case Profile::sphere: return 4 * pi * r * r;
        case Profile::cylinder: return 2 * pi * r * (r + h);
        case Profile::capsule: return 2 * pi * r * (h + 2 * r);
        case Profile::cone: return pi * r * (r + std::hypot(r, h));
        case Profile::torus: return 4 * pi * pi * r * t;
        }
        return 0;
    }

    // Cylinders and cones by rings, which keeps their edges; the smooth ones by even spreading.
    SurfaceSamples sample(const SurfaceSampling& sampling) const override {
        const bool sharp = body_.profile == Profile::cylinder || body_.profile == Profile::cone;
        const double depth = std::min(sampling.inset, largest_depth());
        if (sharp || depth < sampling.inset) return rings(sampling.spacing, sampling.inset);
        const auto candidates = rings(0.25 * sampling.spacing, sampling.inset).positions;
        PoissonDiskLayer layer(sampling.spacing,
            [&](const Vec3& x, double tolerance) { return project(*this, x, sampling.inset, tolerance); });
        layer.choose(candidates);
        layer.relax();
        layer.fill(candidates);
        SurfaceSamples result;
        result.positions = layer.points();
        for (const Vec3& x : result.positions) result.normals.push_back(nearest(x).normal);
        return result;
    }

    SurfaceSamples scatter(const SurfaceSampling& sampling) const override { return rings(sampling.spacing, 0); }

protected:
    // The distance of the deepest point from the surface.
    double largest_depth() const {
        const double r = body_.radius, h = body_.height;
        switch (body_.profile) {
        case Profile::sphere:
        case Profile::capsule: return r;
        case Profile::cylinder: return std::min(r, 0.5 * h);
        case Profile::cone: return r * h / (r + std::hypot(r, h));
        case Profile::torus: return body_.tube;
        }
        return 0;
    }

    // The profile at the depth `inset`, or as deep as each of its lengths allows.
    std::vector<Station> profile(double inset, double spacing) const {
        Walk walk(spacing);
        const double r = std::max(0.0, body_.radius - inset), b = 0.5 * body_.height;
        switch (body_.profile) {
        case Profile::sphere: walk.arc({0, 0}, r, -0.5 * pi, 0.5 * pi); break;
        case Profile::capsule:
            walk.arc({0, -b}, r, -0.5 * pi, 0);
            walk.line({r, -b}, {r, b});
            walk.arc({0, b}, r, 0, 0.5 * pi);
            break;
        case Profile::cylinder: {
            const double half = std::max(0.0, b - inset);
            walk.line({0, -half}, {r, -half});
            if (half > 0) walk.line({r, -half}, {r, half});
            if (half > 0) walk.line({r, half}, {0, half});
            break;
        }
        case Profile::cone: {
            const double depth = std::min(inset, largest_depth());
            const double slant = std::hypot(body_.radius, body_.height);
            const double base = -b + depth, apex = b - depth * slant / body_.radius;
            const double rim = body_.radius * std::max(0.0, apex - base) / body_.height;
            walk.line({0, base}, {rim, base});
            if (rim > 0) walk.line({rim, base}, {0, std::max(apex, base)});
            break;
        }
        case Profile::torus:
            walk.arc({body_.radius, 0}, std::max(0.0, body_.tube - inset), 0, 2 * pi);
            if (walk.stations.size() > 1) walk.stations.pop_back();
        }
        for (Station& s : walk.stations) {
            const double l = std::hypot(s.normal.r, s.normal.h);
            s.normal = l > 0 ? Point2{s.normal.r / l, s.normal.h / l} : Point2{0, 1};
        }
        return std::move(walk.stations);
    }

    void add(const Station& s, const Vec3& direction, SurfaceSamples& result) const {
        result.positions.push_back(body_.centre + s.at.r * direction + s.at.h * body_.axis);
        result.normals.push_back(unit(s.normal.r * direction + s.normal.h * body_.axis, body_.axis));
    }

    SurfaceSamples rings(double spacing, double inset) const {
        SurfaceSamples result;
        const Vec3 other = cross(body_.axis, side_);
        bool staggered = false;
        for (const Station& s : profile(inset, spacing)) {
            auto n = std::max<std::int64_t>(1, count_intervals(2 * pi * s.at.r, spacing));
            while (n > 1 && 2 * s.at.r * std::sin(pi / static_cast<double>(n)) < 0.62 * spacing) --n;
            if (n == 1 && s.at.r < 0.31 * spacing) {
                add({{0, s.at.h}, {0, s.normal.h < 0 ? -1.0 : 1.0}}, side_, result);
                continue;
            }
            for (std::int64_t i = 0; i < n; ++i) {
                const double angle = 2 * pi * (static_cast<double>(i) + (staggered ? 0.5 : 0)) / static_cast<double>(n);
                add(s, std::cos(angle) * side_ + std::sin(angle) * other, result);
            }
            staggered = !staggered;
        }
        if (inset > largest_depth()) result.thin = result.positions.size();
        return result;
    }

    Nearest2 nearest_profile(Point2 p) const {
        const double r = body_.radius, b = 0.5 * body_.height;
        switch (body_.profile) {
        case Profile::sphere: return from_circle(p, {0, 0}, r);
        case Profile::cylinder: return from_cylinder(p, r, b);
        case Profile::capsule: return from_circle(p, {0, std::clamp(p.h, -b, b)}, r);
        case Profile::cone: return from_cone(p, r, b);
        case Profile::torus: return from_circle(p, {r, 0}, body_.tube);
        }
        return {};
    }

    SurfaceOfRevolution body_;
    Vec3 side_;
};

// With axis and centre on the plane z = 0 the closest surface point lies there too: the distance is the body's.
class Outline final : public Round {
public:
    using Round::Round;

    double volume() const override {
        const double r = body_.radius, h = body_.height, t = body_.tube;
        switch (body_.profile) {
        case Profile::sphere: return pi * r * r;
        case Profile::cylinder: return 2 * r * h;
        case Profile::capsule: return 2 * r * h + pi * r * r;
        case Profile::cone: return r * h;
        case Profile::torus: return 2 * pi * t * t;
        }
        return 0;
    }

    double area() const override {
        const double r = body_.radius, h = body_.height, t = body_.tube;
        switch (body_.profile) {
        case Profile::sphere: return 2 * pi * r;
        case Profile::cylinder: return 4 * r + 2 * h;
        case Profile::capsule: return 2 * h + 2 * pi * r;
        case Profile::cone: return 2 * r + 2 * std::hypot(r, h);
        case Profile::torus: return 4 * pi * t;
        }
        return 0;
    }

    SurfaceSamples sample(const SurfaceSampling& sampling) const override {
        SurfaceSamples result;
        for (const Station& s : profile(sampling.inset, sampling.spacing)) {
            if (s.at.r < 1e-9 * sampling.spacing) {
                add({{0, s.at.h}, {0, s.normal.h < 0 ? -1.0 : 1.0}}, side_, result);
                continue;
            }
            add(s, side_, result);
            add(s, -side_, result);
        }
        if (sampling.inset > largest_depth()) result.thin = result.positions.size();
        return result;
    }
    SurfaceSamples scatter(const SurfaceSampling& sampling) const override {
        return sample({sampling.spacing, 0, sampling.clip});
    }
};

} // namespace

SurfacePointer make_revolved(const SurfaceOfRevolution& body) { return std::make_shared<Round>(body); }
SurfacePointer make_outline(const SurfaceOfRevolution& body) { return std::make_shared<Outline>(body); }

} // namespace treacle::scene
