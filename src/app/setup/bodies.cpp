#include "app/setup/bodies.hpp"

#include "app/input/table_text.hpp"
#include "base/text/text.hpp"
#include "sph/solids/solid_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace treacle::app {

namespace {
// Densities, over the liquid's, below and above which a step is no longer sure to be calm (src/sph/measurements.md).
constexpr double light = 0.05, heavy = 50;
// Bodies may touch: overlaps below this share of the spacing do not count.
constexpr double touching = 1e-3;

bool dynamic(const scene::Body& body) { return body.kind == scene::BodyKind::dynamic; }

double distance(const Vec3& a, const Vec3& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

scene::SurfaceSampling on_surface(const Geometry& geometry, const scene::SolidRegion& region) {
    scene::SurfaceSampling sampling{geometry.lattice.spacing, 0, {}};
    // Planes have points in the domain only.
    if (!region.closed()) sampling.clip = {geometry.lattice.min, geometry.lattice.max};
    return sampling;
}

std::vector<rigid::Probe> probes_of(const scene::Body& body, const scene::SolidRegion& region,
                                    const Geometry& geometry) {
    const auto& shape = body.shape;
    if (shape.kind == scene::ShapeKind::sphere && !shape.clip && !region.inverted()) {
        const auto bounds = region.bounds(); // in the plane of the cut
        rigid::Probe ball;
        for (std::size_t k = 0; k < 3; ++k) ball.point[k] = (bounds.min[k] + bounds.max[k]) / 2;
        if (region.dimensions() == 2) ball.point[2] = 0;
        ball.radius = (bounds.max[0] - bounds.min[0]) / 2;
        return {ball};
    }
    std::vector<rigid::Probe> probes;
    for (const auto& x : scene::sample_surface(region, on_surface(geometry, region)).positions) probes.push_back({x, 0});
    return probes;
}

// From the centre to the farthest corner of its bounds, which is no less than to its surface [m].
double reach_of_bounds(const scene::SolidRegion& region, const Vec3& centre) {
    const auto bounds = region.surface_bounds();
    Vec3 most{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(region.dimensions()); ++k) {
        most[k] = std::max(std::fabs(bounds.min[k] - centre[k]), std::fabs(bounds.max[k] - centre[k]));
    }
    return rigid::length(most);
}

enum class Contacts { possible, none };

rigid::BodySetup make_body(const scene::Body& body, std::size_t number, const Geometry& geometry,
                           Contacts contacts = Contacts::possible) {
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
    if (!probed) out.reach = reach_of_bounds(region, out.centre);
    for (const auto& probe : out.probes) {
        out.reach = std::max(out.reach, distance(probe.point, out.centre) + probe.radius);
    }
    return out;
}

// True when some point of a coarse lattice is that deep in the body: in most bodies one is, and surfaces take long to
// sample.
bool surely_reaches(double depth, const scene::SolidRegion& region) {
    constexpr int points = 8; // along each axis
    const auto box = region.surface_bounds(); // of a plane scene without end in z
    for (int n = 0; n < points * points * points; ++n) {
        const std::array<int, 3> place{n % points, n / points % points, n / (points * points)};
        Vec3 x{0, 0, 0};
        for (std::size_t k = 0; k < 3; ++k) {
            if (std::isfinite(box.max[k])) x[k] = box.min[k] + (place[k] + 0.5) / points * (box.max[k] - box.min[k]);
        }
        if (region.distance(x) <= -depth) return true;
    }
    return false;
}

// True when the body is nowhere as thick as a spacing.
bool thinner_than(double spacing, const scene::SolidRegion& region, const Geometry& geometry) {
    const double half = spacing / 2;
    if (surely_reaches(half, region)) return false;
    const auto samples = scene::sample_surface(region, on_surface(geometry, region));
    for (std::size_t i = 0; i < samples.positions.size(); ++i) {
        Vec3 x = samples.positions[i];
        for (std::size_t k = 0; k < 3; ++k) x[k] -= half * samples.normals[i][k];
        if (region.distance(x) <= -half * (1 - 1e-6)) return false;
    }
    return true;
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

// Depth of the one's probes inside the other, and the other way round [m].
double overlap_of(const rigid::BodySetup& a, const rigid::BodySetup& b) {
    double deepest = 0;
    for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
        for (const auto& probe : one->probes) {
            deepest = std::max(deepest, probe.radius - other->region.front().distance(probe.point));
        }
    }
    return deepest;
}

class Checker {
public:
    Checker(const Input& input, const Geometry& geometry) : input_(input), geometry_(geometry) {
        for (std::size_t b = 0; b < geometry.bodies.size(); ++b) {
            setups_.push_back(make_body(body(b), b, geometry));
        }
    }

    void shapes(std::vector<Diagnostic>& problems) const {
        for (std::size_t b = 0; b < setups_.size(); ++b) {
            if (!moves(body(b))) continue;
            const auto& region = geometry_.bodies[b];
            const auto name = "bodies." + body(b).name;
            if (!region.closed()) {
                problems.push_back({body(b).where, name + " moves and has no end", "a plane cannot be carried along",
                                    "take a box, or write kind: static"});
            } else if (dynamic(body(b)) && region.inverted()) {
                problems.push_back({body(b).where, name + " is dynamic and fills all space but a hole",
                                    "its mass would be infinite", "take a shape that is not inverted"});
            } else {
                extent(b, problems);
            }
        }
    }

    void walls(std::vector<Diagnostic>& problems) const {
        const auto& domain = input_.scene.domain;
        for (std::size_t b = 0; b < setups_.size(); ++b) {
            if (!dynamic(body(b))) continue;
            const auto bounds = geometry_.bodies[b].bounds();
            for (std::size_t k = 0; k < static_cast<std::size_t>(domain.dimensions); ++k) {
                const double reach = touching * domain.spacing;
                const bool below = domain.faces[2 * k].kind == scene::FaceKind::wall && bounds.min[k] < domain.min[k] - reach;
                const bool above =
                    domain.faces[2 * k + 1].kind == scene::FaceKind::wall && bounds.max[k] > domain.max[k] + reach;
                if (!below && !above) continue;
                problems.push_back({body(b).where,
                                    "bodies." + body(b).name + " reaches through the wall " + "xyz"[k] +
                                        (below ? "_min" : "_max"),
                                    "a dynamic body cannot start inside of another solid", "move it into the domain"});
            }
        }
    }

    // Pairs of bodies that overlap, and by how much [m].
    template <class Report>
    void overlaps(const Report& report) const {
        for (std::size_t a = 0; a < setups_.size(); ++a) {
            for (std::size_t b = a + 1; b < setups_.size(); ++b) {
                if ((!moves(body(a)) && !moves(body(b))) || joined(body(a).name, body(b).name)) continue;
                const double depth = overlap_of(setups_[a], setups_[b]);
                if (depth > touching * input_.scene.domain.spacing) report(body(a), body(b), depth);
            }
        }
    }

private:
    bool joined(const std::string& a, const std::string& b) const {
        return std::ranges::any_of(input_.scene.joints, [&](const scene::Joint& joint) {
            return (joint.body == a && joint.to == b) || (joint.body == b && joint.to == a);
        });
    }
    const scene::Body& body(std::size_t b) const { return input_.scene.bodies[b]; }

    void extent(std::size_t b, std::vector<Diagnostic>& problems) const {
        const auto& domain = input_.scene.domain;
        const auto name = "bodies." + body(b).name;
        if (dynamic(body(b)) && input_.method.pressure.solver == sph::PressureSolver::dfsph) {
            problems.push_back({body(b).where, name + " is dynamic, with method.pressure.solver: dfsph",
                                "it is there to compare with and knows no bodies that give way",
                                "write kind: kinematic, or another solver"});
        }
        if (dynamic(body(b)) && input_.method.pressure.solid_term == sph::SolidTerm::unknowns) {
            problems.push_back({body(b).where, name + " is dynamic, with method.pressure.solid_term: unknowns",
                                "solids as unknowns are there to compare with and know no bodies that give way",
                                "write kind: kinematic, or another solid_term"});
        }
        if (dynamic(body(b)) && input_.method.pressure.corrections > 0) {
            problems.push_back({body(b).where, name + " is dynamic, with method.pressure.corrections",
                                "they would take it to stand still, and push liquid and body apart",
                                "write kind: kinematic, or leave the corrections out"});
        }
        for (std::size_t k = 0; k < static_cast<std::size_t>(domain.dimensions); ++k) {
            const bool periodic = domain.faces[2 * k].kind == scene::FaceKind::periodic;
            if (periodic && !geometry_.spans[b][k]) fits_period(b, k, problems);
        }
    }

    // A body that moves, along an axis whose period it is not as long as without a gap.
    void fits_period(std::size_t b, std::size_t k, std::vector<Diagnostic>& problems) const {
        const auto& domain = input_.scene.domain;
        const auto name = "bodies." + body(b).name;
        const std::string axis(1, "xyz"[k]);
        const auto bounds = geometry_.originals[b].bounds();
        const double period = domain.max[k] - domain.min[k], length = bounds.max[k] - bounds.min[k];
        const bool turns = may_turn(body(b), k, domain.dimensions), meets = std::fabs(length - period) <= 1e-6 * domain.spacing;
        if ((turns ? 2 * setups_[b].reach : length) < period && !meets) return;
        const auto [given, least] = tell_apart(meets ? period : length, period);
        if (turns && (meets || length < period)) {
            problems.push_back({body(b).where, name + " may turn, and is longer than the period in " + axis + " then",
                                "it could meet its own image",
                                "shorten it, lengthen the domain, or take its rotation away (`locked` of a dynamic body)"});
        } else if (meets) {
            problems.push_back({body(b).where, name + " moves and is as long as the period in " + axis + ", " + given + " m",
                                "the ends of a body meet those of its images only where they are flat, of a box that is not turned "
                                "or a cylinder along " + axis,
                                "take one of these, shorten the body, or lengthen the domain"});
        } else {
            problems.push_back({body(b).where, name + " moves and is " + given + " m long in " + axis + ", more than the period of " + least + " m",
                                "it could meet its own image", "make it as long as the period, so that its ends meet, or shorter"});
        }
    }

    const Input& input_;
    const Geometry& geometry_;
    std::vector<rigid::BodySetup> setups_;
};
} // namespace

bool moves(const scene::Body& body) { return body.kind != scene::BodyKind::fixed; }

bool any_moves(const Input& input) {
    return std::any_of(input.scene.bodies.begin(), input.scene.bodies.end(), moves);
}

bool any_dynamic(const Input& input) {
    return std::any_of(input.scene.bodies.begin(), input.scene.bodies.end(), dynamic);
}

double density_of(const scene::Body& body, const scene::SolidRegion& region) {
    return body.mass > 0 ? body.mass / region.volume() : body.density;
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
        setup.lever = bodies[setup.body].reach;
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
        if (domain.faces[2 * k].kind == scene::FaceKind::wall) out.walls.push_back({axis, domain.min[k], 1});
        if (domain.faces[2 * k + 1].kind == scene::FaceKind::wall) out.walls.push_back({axis, domain.max[k], -1});
    }
    return out;
}

namespace {
// Bodies that joints and locked degrees of freedom leave no motion.
void check_freedom(const Input& input, const Geometry& geometry, std::vector<Diagnostic>& problems) {
    const auto mobility = rigid::RigidBodies(make_bodies(input, geometry)).mobility();
    for (std::size_t b = 0; b < geometry.bodies.size(); ++b) {
        const auto& body = input.scene.bodies[b];
        if (!dynamic(body) || mobility.can_move(b)) continue;
        const auto joint = std::ranges::find_if(
            input.scene.joints, [&](const scene::Joint& one) { return one.body == body.name || one.to == body.name; });
        const bool joins = joint != input.scene.joints.end();
        problems.push_back({joins ? joint->where : body.where,
                            "bodies." + body.name + " cannot move: " +
                                (joins ? "its joints and locked degrees of freedom hold all six"
                                       : "all its degrees of freedom are locked"),
                            "no force on it would show", "write kind: static, or free one of them"});
    }
}
} // namespace

std::string describe(const scene::Joint& joint) {
    std::string out = std::string(kind_name(joint.kind)) + " of " + joint.body + " to " +
                      (joint.to.empty() ? "the world" : joint.to) + ", at (";
    for (std::size_t k = 0; k < 3; ++k) out += (k > 0 ? ", " : "") + short_number(joint.point[k]);
    return out + ") m";
}

std::vector<double> solid_scales(const Input& input, const Geometry& geometry) {
    std::vector<double> out;
    const auto wall = wall_setup(input);
    const sph::ScaleSetup setup{wall, geometry.offset + wall.spacing / 2};
    for (std::size_t b = 0; b < geometry.bodies.size(); ++b) {
        const auto& region = geometry.bodies[b];
        auto sampling = body_sampling(geometry, b);
        if (moves(input.scene.bodies[b])) sampling.clip = {}; // with its images, where it is as long as a period
        out.push_back(moves(input.scene.bodies[b]) ? sph::solid_scale(setup, region, scene::sample_surface(region, sampling).positions) : 1.0);
    }
    return out;
}

namespace {
// In SPH what rests or is driven may be thinner: its samples hold liquid back on both sides.
void check_thickness(const Input& input, const Geometry& geometry, std::vector<Diagnostic>& problems) {
    for (std::size_t b = 0; b < geometry.bodies.size(); ++b) {
        const auto& body = input.scene.bodies[b];
        if (!(dynamic(body) || input.on_grid()) || !geometry.bodies[b].closed()) continue;
        if (!thinner_than(input.scene.domain.spacing, geometry.bodies[b], geometry)) continue;
        problems.push_back({body.where, "bodies." + body.name + " is thinner than domain.spacing",
                            input.on_grid() ? "no cell would lie within it, and liquid would pass through it"
                                            : "liquid on one side would feel the liquid on the other, and it could not float",
                            "thicken it, or refine domain.spacing"});
    }
}
} // namespace

void check_bodies(const Input& input, const Geometry& geometry, std::vector<Diagnostic>& problems) {
    check_thickness(input, geometry, problems);
    if (!any_moves(input)) return;
    const Checker checker(input, geometry);
    checker.shapes(problems);
    checker.walls(problems);
    checker.overlaps([&](const scene::Body& a, const scene::Body& b, double depth) {
        if (!dynamic(a) && !dynamic(b)) return;
        problems.push_back({(dynamic(b) ? b : a).where,
                            "bodies." + a.name + " overlaps bodies." + b.name + " by " + short_number(depth) + " m",
                            "a dynamic body cannot start inside of another solid", "move one of the two"});
    });
    if (problems.empty()) check_freedom(input, geometry, problems);
}

std::vector<std::string> body_notes(const Input& input, const Geometry& geometry) {
    std::vector<std::string> notes;
    if (!any_moves(input)) return notes;
    Checker(input, geometry).overlaps([&](const scene::Body& a, const scene::Body& b, double depth) {
        if (dynamic(a) || dynamic(b)) return;
        notes.push_back("bodies." + a.name + " overlaps bodies." + b.name + " by " + short_number(depth) +
                        " m at the start: nothing keeps them apart, and liquid between them is crushed");
    });
    for (std::size_t b = 0; b < geometry.bodies.size(); ++b) {
        const auto& body = input.scene.bodies[b];
        if (!dynamic(body)) continue;
        const auto [thin, dense] = std::ranges::minmax(input.scene.liquids, {}, &scene::Liquid::density);
        for (const auto* liquid : {&thin, &dense}) {
            const double ratio = density_of(body, geometry.originals[b]) / liquid->density;
            if (ratio >= light && ratio <= heavy) continue;
            const auto [given, bound] = tell_apart(ratio, ratio < light ? light : heavy);
            notes.push_back("bodies." + body.name + " has " + given + " times the density of " +
                            liquid->name + ": its motion is sure from " + (ratio < light ? bound : short_number(light)) + " to " +
                            (ratio < light ? short_number(heavy) : bound) + " times, beyond that take smaller steps and compare");
            break;
        }
    }
    return notes;
}

} // namespace treacle::app
