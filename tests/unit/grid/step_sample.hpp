#pragma once
#include "grid/grid_step.hpp"
#include "scene/shapes/shape.hpp"

#include <cmath>
#include <functional>
#include <map>
#include <memory>

// Runs of the whole step, with liquid given by its distance.
namespace treacle::grid {

struct StepSample {
    GridSetup setup;
    std::function<double(const Vec3&)> liquid; // [m] < 0 inside
    std::function<Vec3(const Vec3&)> velocity = [](const Vec3&) { return Vec3{0, 0, 0}; };
    std::array<Vec3, 3> gradient{}; // of the velocity, rows by component [1/s]
    double jitter = 0.1;            // of the particles' spacing
};

// Of `cells` along the unit length, in a cube of walls.
inline StepSample sample_of(int cells, int dimensions) {
    StepSample sample;
    auto& domain = sample.setup.domain;
    domain.dimensions = dimensions;
    domain.spacing = 1.0 / cells;
    domain.gravity = dimensions == 3 ? Vec3{0, 0, -9.81} : Vec3{0, -9.81, 0};
    sample.setup.rigid.dimensions = dimensions;
    sample.setup.rigid.gravity = domain.gravity;
    sample.setup.rigid.spacing = domain.spacing;
    return sample;
}

// A number in [-1, 1] of a number.
inline double scatter(std::int64_t n) {
    auto x = static_cast<std::uint64_t>(n) * 0x9E3779B97F4A7C15ull;
    x ^= x >> 31;
    x *= 0xBF58476D1CE4E5B9ull;
    x ^= x >> 27;
    return double(x >> 11) / double(1ull << 52) - 1;
}

// Puts two particles per cell and axis into the liquid, on rank 0, and starts.
inline std::unique_ptr<GridStep> started(const Comm& comm, const StepSample& sample) {
    auto step = std::make_unique<GridStep>(comm, sample.setup);
    auto& particles = step->particles();
    const auto& domain = sample.setup.domain;
    std::vector<Vec3> positions;
    std::vector<std::int64_t> ids;
    if (comm.is_root()) {
        const double d = domain.spacing / 2;
        std::array<std::int64_t, 3> n{1, 1, 1};
        for (std::size_t k = 0; k < static_cast<std::size_t>(domain.dimensions); ++k) {
            n[k] = std::llround((domain.max[k] - domain.min[k]) / d);
        }
        for (std::int64_t i = 0; i < n[0] * n[1] * n[2]; ++i) {
            const std::int64_t index[3] = {i % n[0], i / n[0] % n[1], i / (n[0] * n[1])};
            Vec3 x{0, 0, 0};
            for (std::size_t k = 0; k < static_cast<std::size_t>(domain.dimensions); ++k) {
                const double shift = sample.jitter * scatter(3 * i + static_cast<std::int64_t>(k));
                x[k] = domain.min[k] + d * (double(index[k]) + 0.5 + shift);
            }
            if (!(sample.liquid(x) < 0)) continue;
            positions.push_back(x);
            ids.push_back(i);
        }
    }
    particles.store.resize_owned(static_cast<int>(positions.size()));
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const auto u = sample.velocity(positions[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            particles.position()(i, k) = positions[i][k];
            particles.velocity()(i, k) = u[k];
            for (int a = 0; a < 3; ++a) particles.affine(a)(i, k) = sample.gradient[static_cast<std::size_t>(a)][k];
        }
        particles.id()(i) = ids[i];
        particles.liquid()(i) = 0;
        particles.viscosity()(i) = sample.setup.viscosity;
    }
    step->start();
    return step;
}

// Places and velocities by id, of this rank.
using States = std::map<std::int64_t, std::array<double, 6>>;
inline States states(const GridStep& step) {
    States out;
    const auto& p = step.particles();
    for (int i = 0; i < p.store.owned(); ++i) {
        auto& state = out[p.id()(i)];
        for (std::size_t k = 0; k < 3; ++k) {
            state[k] = p.position()(i, k);
            state[3 + k] = p.velocity()(i, k);
        }
    }
    return out;
}

// Distance [m].
inline double from(const Vec3& centre, const Vec3& x) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += (x[k] - centre[k]) * (x[k] - centre[k]);
    return std::sqrt(sum);
}

// A ball that moves freely, of a density [kg/m3].
inline rigid::BodySetup ball_body(const Vec3& centre, double radius, double density) {
    scene::Shape shape;
    shape.kind = scene::ShapeKind::sphere;
    shape.centre = centre;
    shape.radius = radius;
    rigid::BodySetup body;
    body.kind = scene::BodyKind::dynamic;
    body.centre = centre;
    body.mass = density * 4.0 / 3 * math::pi * radius * radius * radius;
    for (std::size_t k = 0; k < 3; ++k) body.inertia[k][k] = 0.4 * body.mass * radius * radius;
    body.region = {scene::SolidRegion(shape)};
    body.bounding_radius = radius;
    return body;
}

} // namespace treacle::grid
