#include "app/setup/bodies.hpp"

#include "app/input/table_text.hpp"
#include "base/text/text.hpp"
#include "sph/solids/boundary_volume_factor.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {
double distance(const Vec3& a, const Vec3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

std::vector<rigid::ContactSample> probes_of(
    const scene::Body& body, const scene::SolidRegion& region, const Geometry& geometry) {
    const auto& shape = body.shape;
    if (shape.kind == scene::ShapeKind::sphere && !shape.clip && !region.inverted()) {
        const auto bounds = region.bounds(); // of the cut, in its plane
        rigid::ContactSample ball;
        for (std::size_t k = 0; k < 3; ++k) ball.point[k] = (bounds.min[k] + bounds.max[k]) / 2;
        if (region.dimensions() == 2) ball.point[2] = 0;
        ball.radius = (bounds.max[0] - bounds.min[0]) / 2;
        return {ball};
    }
    std::vector<rigid::ContactSample> probes;
    for (const auto& x : scene::sample_surface(region, on_surface(geometry, region)).positions)
        probes.push_back({x, 0});
    return probes;
}

// From the centre to the farthest corner of its bounds, which is no less than to its surface [m].
double radius_of_bounds(const scene::SolidRegion& region, const Vec3& centre) {
    const auto bounds = region.surface_bounds();
    Vec3 most{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(region.dimensions()); ++k) {
        most[k] = std::max(std::fabs(bounds.min[k] - centre[k]), std::fabs(bounds.max[k] - centre[k]));
    }
    return rigid::length(most);
}

const char* kind_name(scene::JointKind kind) {
    switch (kind) {
    case scene::JointKind::hinge: return "hinge";
    case scene::JointKind::ball: return "ball";
    case scene::JointKind::slider: return "slider";
    }
    return "joint";
}

std::size_t number_of(const Input& input, const std::string& body) {
    const auto& bodies = input.scene.bodies;
    return static_cast<std::size_t>(std::ranges::find(bodies, body, &scene::Body::name) - bodies.begin());
}
} // namespace

bool moves(const scene::Body& body) { return body.kind != scene::BodyKind::fixed; }
bool dynamic(const scene::Body& body) { return body.kind == scene::BodyKind::dynamic; }

bool any_moves(const Input& input) { return std::any_of(input.scene.bodies.begin(), input.scene.bodies.end(), moves); }

bool any_dynamic(const Input& input) {
    return std::any_of(input.scene.bodies.begin(), input.scene.bodies.end(), dynamic);
}

double density_of(const scene::Body& body, const scene::SolidRegion& region) {
    return body.mass > 0 ? body.mass / region.volume() : body.density;
}

scene::SurfaceSampling on_surface(const Geometry& geometry, const scene::SolidRegion& region) {
    scene::SurfaceSampling sampling{geometry.lattice.spacing, 0, {}};
    // Planes have points in the domain only.
    if (!region.closed()) sampling.clip = {geometry.lattice.min, geometry.lattice.max};
    return sampling;
}

rigid::BodySetup make_body(const scene::Body& body, std::size_t number, const Geometry& geometry, Contacts contacts) {
    const auto &region = geometry.bodies[number], &original = geometry.originals[number];
    rigid::BodySetup out;
    out.name = body.name;
    out.kind = body.kind;
    out.keyframes = body.keyframes;
    out.velocity = body.velocity;
    out.angular_velocity = body.angular_velocity;
    out.locked = body.locked;
    out.restitution = body.restitution;
    out.friction = body.friction;
    out.region = {region};
    // A mesh has thousands of probes; what rests where nothing falls needs none.
    const bool probed = contacts == Contacts::possible || body.kind != scene::BodyKind::fixed || !region.closed();
    if (probed) out.probes = probes_of(body, region, geometry);
    if (region.closed()) {
        const auto moments = original.moments();
        out.centre = body.pivot.value_or(moments.centre);
        if (dynamic(body)) {
            const double density = density_of(body, original);
            out.mass = density * moments.volume;
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t j = 0; j < 3; ++j) out.inertia[i][j] = density * moments.inertia[i][j];
            }
        }
    }
    if (!probed) out.bounding_radius = radius_of_bounds(region, out.centre);
    for (const auto& probe : out.probes) {
        out.bounding_radius = std::max(out.bounding_radius, distance(probe.point, out.centre) + probe.radius);
    }
    return out;
}

namespace {
std::vector<rigid::JointSetup> make_joints(const Input& input, const std::vector<rigid::BodySetup>& bodies) {
    std::vector<rigid::JointSetup> out;
    for (const auto& joint : input.scene.joints) {
        rigid::JointSetup setup;
        setup.name = joint.name;
        setup.kind = joint.kind;
        setup.body = number_of(input, joint.body);
        if (!joint.to.empty()) setup.other = static_cast<int>(number_of(input, joint.to));
        setup.point = joint.point;
        for (std::size_t k = 0; k < 3; ++k) setup.axis[k] = joint.axis[k] / distance(joint.axis, {0, 0, 0});
        setup.length_scale = bodies[setup.body].bounding_radius;
        out.push_back(setup);
    }
    return out;
}
} // namespace

rigid::BodiesSetup make_bodies(const Input& input, const Geometry& geometry) {
    rigid::BodiesSetup out;
    const auto& domain = input.scene.domain;
    out.spacing = domain.spacing;
    out.gravity = domain.gravity;
    out.dimensions = domain.dimensions;
    const auto contacts = std::ranges::any_of(input.scene.bodies, dynamic) ? Contacts::possible : Contacts::none;
    for (std::size_t b = 0; b < geometry.bodies.size(); ++b) {
        out.bodies.push_back(make_body(input.scene.bodies[b], b, geometry, contacts));
    }
    out.joints = make_joints(input, out.bodies);
    const auto box = sph::make_domain_box(domain, 0);
    for (std::size_t k = 0; k < static_cast<std::size_t>(domain.dimensions); ++k) {
        out.period[k] = box.period[k];
        const int axis = static_cast<int>(k);
        if (domain.faces[2 * k].kind == scene::BoundaryKind::wall) out.walls.push_back({axis, domain.min[k], 1});
        if (domain.faces[2 * k + 1].kind == scene::BoundaryKind::wall) out.walls.push_back({axis, domain.max[k], -1});
    }
    return out;
}

std::string describe(const scene::Joint& joint) {
    std::string out = std::string(kind_name(joint.kind)) + " of " + joint.body + " to " +
                      (joint.to.empty() ? "the world" : joint.to) + ", at (";
    for (std::size_t k = 0; k < 3; ++k) out += (k > 0 ? ", " : "") + short_number(joint.point[k]);
    return out + ") m";
}

std::vector<double> boundary_volume_factors(const Input& input, const Geometry& geometry) {
    std::vector<double> out;
    const auto wall = wall_setup(input);
    const sph::ScaleSetup setup{wall, geometry.offset + wall.spacing / 2};
    for (std::size_t b = 0; b < geometry.bodies.size(); ++b) {
        const auto& region = geometry.bodies[b];
        auto sampling = body_sampling(geometry, b);
        if (moves(input.scene.bodies[b])) sampling.clip = {}; // with its images, where it is as long as a period
        out.push_back(moves(input.scene.bodies[b]) ? sph::boundary_volume_factor(setup, region,
                                                         scene::sample_surface(region, sampling).positions)
                                                   : 1.0);
    }
    return out;
}

} // namespace treacle::app
