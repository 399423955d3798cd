#include "app/setup/body_checks.hpp"

#include "app/input/table_text.hpp"
#include "app/setup/bodies.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace treacle::app {

namespace {
// Densities, over the liquid's, below and above which a step is no longer sure to be calm (src/sph/measurements.md).
constexpr double light = 0.05, heavy = 50;
// Bodies may touch: overlaps below this share of the spacing do not count.
constexpr double touching = 1e-3;

// True when some point of a coarse lattice is that deep in the body: in most bodies one is, and surfaces take long to
// sample.
bool surely_as_deep(double depth, const scene::SolidRegion& region) {
    constexpr int points = 8;                 // along each axis
    const auto box = region.surface_bounds(); // of a 2D scene without end in z
    for (int n = 0; n < points * points * points; ++n) {
        const std::array<int, 3> index{n % points, n / points % points, n / (points * points)};
        Vec3 x{0, 0, 0};
        for (std::size_t k = 0; k < 3; ++k) {
            if (std::isfinite(box.max[k])) x[k] = box.min[k] + (index[k] + 0.5) / points * (box.max[k] - box.min[k]);
        }
        if (region.distance(x) <= -depth) return true;
    }
    return false;
}

// True when the body is nowhere as thick as a spacing.
bool thinner_than(double spacing, const scene::SolidRegion& region, const Geometry& geometry) {
    const double half = spacing / 2;
    if (surely_as_deep(half, region)) return false;
    const auto samples = scene::sample_surface(region, on_surface(geometry, region));
    for (std::size_t i = 0; i < samples.positions.size(); ++i) {
        Vec3 x = samples.positions[i];
        for (std::size_t k = 0; k < 3; ++k) x[k] -= half * samples.normals[i][k];
        if (region.distance(x) <= -half * (1 - 1e-6)) return false;
    }
    return true;
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
            setups_.push_back(make_body(body(b), b, geometry, Contacts::possible));
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
                const double margin = touching * domain.spacing;
                const bool below =
                    domain.faces[2 * k].kind == scene::BoundaryKind::wall && bounds.min[k] < domain.min[k] - margin;
                const bool above =
                    domain.faces[2 * k + 1].kind == scene::BoundaryKind::wall && bounds.max[k] > domain.max[k] + margin;
                if (!below && !above) continue;
                problems.push_back({body(b).where,
                    "bodies." + body(b).name + " reaches through the wall " + "xyz"[k] + (below ? "_min" : "_max"),
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
            const bool periodic = domain.faces[2 * k].kind == scene::BoundaryKind::periodic;
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
        const bool turns = may_turn(body(b), k, domain.dimensions),
                   meets = std::fabs(length - period) <= 1e-6 * domain.spacing;
        if ((turns ? 2 * setups_[b].bounding_radius : length) < period && !meets) return;
        const auto [given, least] = tell_apart(meets ? period : length, period);
        if (turns && (meets || length < period)) {
            problems.push_back({body(b).where, name + " may turn, and is longer than the period in " + axis + " then",
                "it could meet its own image",
                "shorten it, lengthen the domain, or take its rotation away (`locked` of a dynamic body)"});
        } else if (meets) {
            problems.push_back(
                {body(b).where, name + " moves and is as long as the period in " + axis + ", " + given + " m",
                    "the ends of a body meet those of its images only where they are flat, of a box that is not turned "
                    "or a cylinder along " +
                        axis,
                    "take one of these, shorten the body, or lengthen the domain"});
        } else {
            problems.push_back({body(b).where,
                name + " moves and is " + given + " m long in " + axis + ", more than the period of " + least + " m",
                "it could meet its own image", "make it as long as the period, so that its ends meet, or shorter"});
        }
    }

    const Input& input_;
    const Geometry& geometry_;
    std::vector<rigid::BodySetup> setups_;
};

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

std::vector<std::string> body_warnings(const Input& input, const Geometry& geometry) {
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
            notes.push_back("bodies." + body.name + " has " + given + " times the density of " + liquid->name +
                            ": its motion is sure from " + (ratio < light ? bound : short_number(light)) + " to " +
                            (ratio < light ? short_number(heavy) : bound) +
                            " times, beyond that take smaller steps and compare");
            break;
        }
    }
    return notes;
}

} // namespace treacle::app
