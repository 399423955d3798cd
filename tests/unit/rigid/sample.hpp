#pragma once
#include "rigid/bodies.hpp"
#include "scene/sampling/sampling.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace treacle::rigid {

constexpr double gravity = 9.81; // [m/s2]

inline scene::Shape box(const Vec3& min, const Vec3& max) {
    scene::Shape shape;
    shape.kind = scene::ShapeKind::box;
    shape.min = min;
    shape.max = max;
    return shape;
}

inline scene::Shape ball(const Vec3& centre, double radius) {
    scene::Shape shape;
    shape.kind = scene::ShapeKind::sphere;
    shape.centre = centre;
    shape.radius = radius;
    return shape;
}

// A dynamic body of density 1000, its surface probed at every 5 cm.
inline BodySetup make_body(const scene::Shape& shape, int dimensions = 3) {
    BodySetup out;
    out.kind = scene::BodyKind::dynamic;
    const scene::SolidRegion region(shape, dimensions);
    const auto moments = region.moments();
    out.mass = 1000 * moments.volume;
    out.centre = moments.centre;
    for (std::size_t i = 0; i < 3; ++i) out.inertia[i] = 1000 * moments.inertia[i];
    if (shape.kind == scene::ShapeKind::sphere) {
        out.probes = {{shape.centre, shape.radius}};
    } else {
        for (const auto& x : scene::sample_surface(region, {0.05, 0, {}}).positions) out.probes.push_back({x, 0});
    }
    for (const auto& probe : out.probes) {
        out.bounding_radius = std::max(out.bounding_radius, length(probe.point - out.centre) + probe.radius);
    }
    out.region = {region};
    return out;
}

inline BodiesSetup world(std::vector<BodySetup> bodies, int dimensions = 3) {
    BodiesSetup setup;
    setup.bodies = std::move(bodies);
    setup.dimensions = dimensions;
    setup.spacing = 0.05;
    return setup;
}

// With gravity and a floor at 0.
inline BodiesSetup on_floor(std::vector<BodySetup> bodies, int dimensions = 3) {
    auto setup = world(std::move(bodies), dimensions);
    const auto up = static_cast<std::size_t>(dimensions - 1);
    setup.gravity[up] = -gravity;
    setup.walls = {{dimensions - 1, 0, 1}};
    return setup;
}

inline void run(RigidBodies& bodies, double dt, int steps) {
    for (int k = 0; k < steps; ++k) {
        bodies.begin(dt);
        bodies.fall(dt);
        bodies.move(dt);
    }
}

} // namespace treacle::rigid
