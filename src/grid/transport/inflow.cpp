#include "grid/transport/inflow.hpp"

#include "grid/geometry/seeding.hpp"
#include "grid/transport/synchronise.hpp"
#include "rigid/algebra.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::grid {

namespace {
// Axis times angle of the rotation that takes x to `along` and z to `direction`, which are at right angles.
Vec3 rotation_to(const Vec3& along, const Vec3& direction) {
    using namespace rigid;
    const Vec3 axis = cross({0, 0, 1}, direction);
    const double sine = length(axis);
    Quaternion first;
    if (sine > 1e-12) {
        first = rotation_by((std::atan2(sine, direction[2]) / sine) * axis);
    } else if (direction[2] < 0) {
        first = rotation_by({math::pi, 0, 0});
    }
    const Vec3 x = to_matrix(first) * Vec3{1, 0, 0};
    const double angle = std::atan2(dot(cross(x, along), direction), dot(x, along));
    return rotation_vector(product(rotation_by(angle * direction), first));
}

// Farthest points of a layer along a direction, with half a spacing on either side [m].
double extent(const flow::InletSetup& inlet, const Vec3& direction, double spacing) {
    double most = 0;
    for (const auto& point : inlet.points) most = std::max(most, rigid::dot(point, direction));
    return 2 * most + spacing;
}

scene::Shape plug_shape(const flow::InletSetup& inlet, const Vec3& middle, double spacing, int dimensions) {
    using namespace rigid;
    scene::Shape shape;
    const double depth = inlet_body_layers * spacing;
    const bool plane = dimensions == 2;
    const double dense =
        spacing / flow::step_of(inlet, {spacing, 0}); // points are as much farther apart as layers are nearer
    const double across = spacing * (plane ? dense : std::sqrt(dense));
    if (inlet.round) {
        shape.kind = scene::ShapeKind::cylinder;
        shape.centre = middle;
        shape.axis = inlet.direction;
        shape.radius = across * std::sqrt(double(inlet.points.size()) / math::pi);
        shape.height = depth;
        return shape;
    }
    const Vec3 second = cross(inlet.direction, inlet.along);
    const Vec3 size{extent(inlet, inlet.along, across), plane ? depth : extent(inlet, second, across), depth};
    shape.min = middle - 0.5 * size;
    shape.max = middle + 0.5 * size;
    const Vec3 turn =
        plane ? Vec3{0, 0, std::atan2(inlet.along[1], inlet.along[0])} : rotation_to(inlet.along, inlet.direction);
    shape.rotation_angle = length(turn);
    if (shape.rotation_angle > 0) shape.rotation_axis = (1 / shape.rotation_angle) * turn;
    return shape;
}
} // namespace

flow::Layers layers_of(const MacGrid& grid) { return {grid.dx / particles_per_axis, 0}; }

std::vector<rigid::BodySetup> make_inlet_bodies(const flow::InflowSetup& setup, const MacGrid& grid) {
    using namespace rigid;
    const double spacing = layers_of(grid).spacing;
    std::vector<BodySetup> out;
    for (const auto& inlet : setup.inlets) {
        BodySetup plug;
        plug.name = "plug";
        plug.kind = scene::BodyKind::kinematic;
        plug.surface_velocity_only = true;
        plug.from = inlet.start;
        if (inlet.end > 0) plug.until = inlet.end;
        plug.velocity = inlet.speed * inlet.direction;
        plug.centre = inlet.centre - (0.5 * inlet_body_layers * spacing) * inlet.direction;
        plug.region.emplace_back(plug_shape(inlet, plug.centre, spacing, grid.dimensions), grid.dimensions);
        const auto bounds = plug.region.front().bounds();
        plug.bounding_radius = 0.5 * length(bounds.max - bounds.min);
        out.push_back(std::move(plug));
    }
    return out;
}

flow::InletEmitter make_inlet_emitter(const flow::InflowSetup& setup, const MacGrid& grid) {
    return {setup, layers_of(grid), periodic_box(grid)};
}

void emit_layers(const flow::InletEmitter& source, const TimeSpan& time, const Decomposition& decomposition,
    GridParticles& particles) {
    const int before = particles.store.owned();
    const flow::InletEmitter::Fields fields{
        particles.velocity_field(), particles.liquid_field(), particles.viscosity_field()};
    for (std::size_t q = 0; q < source.setup().inlets.size(); ++q) {
        const auto& inlet = source.setup().inlets[q];
        const auto due = layers_until(inlet, source.layers(), time.end);
        for (auto layer = layers_until(inlet, source.layers(), time.begin); layer < due; ++layer) {
            source.add(particles.store, fields, decomposition.grid(), decomposition.box(), {q, layer, time.end});
        }
    }
    begin_velocities(particles, before);
}

} // namespace treacle::grid
