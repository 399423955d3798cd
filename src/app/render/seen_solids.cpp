#include "app/render/seen_solids.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "surface/mesh/mirror.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace treacle::app {

namespace {

// Distance from a box, negative inside [m].
double box_distance(const Vec3& min, const Vec3& max, const Vec3& x) {
    double outside = 0, inside = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const double d = std::max(min[k] - x[k], x[k] - max[k]);
        if (d > 0) outside += d * d;
        inside = std::max(inside, d);
    }
    return outside > 0 ? std::sqrt(outside) : inside;
}

scene::Bounds bounds_within(const scene::Regions& regions, const scene::Domain& domain) {
    scene::Bounds out;
    for (std::size_t k = 0; k < 3; ++k) {
        out.min[k] = domain.max[k];
        out.max[k] = domain.min[k];
        for (const auto& region : regions) {
            const auto bounds = region.bounds();
            out.min[k] = std::min(out.min[k], std::max(bounds.min[k], domain.min[k]));
            out.max[k] = std::max(out.max[k], std::min(bounds.max[k], domain.max[k]));
        }
    }
    return out;
}

void set_ball(video::SeenSolid& solid, const scene::Bounds& bounds) {
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        solid.centre[k] = 0.5 * (bounds.min[k] + bounds.max[k]);
        square += std::pow(0.5 * (bounds.max[k] - bounds.min[k]), 2);
    }
    solid.radius = 1.001 * std::sqrt(square);
}

void add_image(scene::Bounds& bounds, const scene::MirrorPlane& mirror) {
    const auto k = mirror.axis;
    const double low = 2 * mirror.position - bounds.max[k], high = 2 * mirror.position - bounds.min[k];
    bounds.min[k] = std::min(bounds.min[k], low);
    bounds.max[k] = std::max(bounds.max[k], high);
}

} // namespace

video::SeenSolid seen_liquid(const Input& input, const Geometry& geometry, std::size_t liquid) {
    const auto& domain = input.scene.domain;
    const bool without_bodies = input.scene.liquids[liquid].subtract_bodies;
    video::SeenSolid out;
    out.name = "liquids." + input.scene.liquids[liquid].name;
    out.distance = [regions = geometry.liquids[liquid], bodies = without_bodies ? geometry.bodies : scene::Regions{},
                       min = domain.min, max = domain.max, domain](const Vec3& point) {
        const auto x = surface::folded(point, domain);
        double d = std::max(scene::distance_to(regions, x), box_distance(min, max, x));
        if (!bodies.empty()) d = std::max(d, -scene::distance_to(bodies, x));
        return d;
    };
    auto bounds = bounds_within(geometry.liquids[liquid], domain);
    for (const auto& mirror : domain.mirrors()) add_image(bounds, mirror);
    set_ball(out, bounds);
    return out;
}

video::SeenSolid seen_body(const Input& input, const Geometry& geometry, std::size_t body) {
    video::SeenSolid out;
    out.name = "bodies." + input.scene.bodies[body].name;
    const auto& region = geometry.originals[body];
    out.distance = [region](const Vec3& x) { return region.distance(x); };
    if (!region.closed() || region.inverted())
        throw InputError({input.scene.bodies[body].where, out.name + " has no end", "it has no outline",
            "give a body of finite extent"});
    set_ball(out, region.bounds());
    return out;
}

video::SeenSolid find_seen_solid(const Input& input, const Geometry& geometry, const std::string& name) {
    const auto& scene = input.scene;
    if (scene.domain.dimensions != 3)
        throw InputError({scene.domain.where, "the scene is in two dimensions", "a camera sees a scene in three",
            "give the scene in three dimensions"});
    std::vector<std::string> names;
    std::vector<video::SeenSolid> liquids;
    for (std::size_t i = 0; i < scene.liquids.size(); ++i) {
        names.push_back(scene.liquids[i].name);
        if (scene.liquids[i].shapes.empty()) continue;
        if (name == names.back()) return seen_liquid(input, geometry, i);
        liquids.push_back(seen_liquid(input, geometry, i));
    }
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        names.push_back(scene.bodies[i].name);
        if (name == names.back()) return seen_body(input, geometry, i);
    }
    if (!name.empty() && name != "liquid")
        throw InputError(
            {"--contour-of " + name, "the scene has no such liquid or body", "there are " + join(names, ", "), ""});
    if (liquids.empty())
        throw InputError(
            {"--contour-of", "no liquid of the scene is there at the start", "inlets pour later", "name a body"});
    if (liquids.size() == 1) return liquids.front();
    video::SeenSolid all = liquids.front();
    all.name = "the liquids";
    Vec3 low = all.centre, high = all.centre;
    for (const auto& one : liquids)
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], one.centre[k] - one.radius);
            high[k] = std::max(high[k], one.centre[k] + one.radius);
        }
    scene::Bounds bounds;
    bounds.min = low;
    bounds.max = high;
    set_ball(all, bounds);
    all.distance = [liquids](const Vec3& x) {
        double least = std::numeric_limits<double>::infinity();
        for (const auto& one : liquids) least = std::min(least, one.distance(x));
        return least;
    };
    return all;
}

} // namespace treacle::app
