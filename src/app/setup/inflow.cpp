#include "app/setup/inflow.hpp"

#include "app/input/table_text.hpp"
#include "base/text/text.hpp"
#include "grid/geometry/seeding.hpp"
#include "grid/transport/inflow.hpp"
#include "sph/forces/inflow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace treacle::app {

namespace {
// Openings narrower than that many spacings are warned of.
constexpr double fine_opening = 6;

double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vec3 unit(const Vec3& v) {
    const double length = std::sqrt(dot(v, v));
    return {v[0] / length, v[1] / length, v[2] / length};
}

Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Part of a vector across a direction.
Vec3 across(const Vec3& v, const Vec3& direction) {
    const double along = dot(v, direction);
    return {v[0] - along * direction[0], v[1] - along * direction[1], v[2] - along * direction[2]};
}

// The coordinate axis that is least along the direction; in 2D what is across it and not z.
Vec3 width_of(const scene::Inlet& inlet, const Vec3& direction, int dimensions) {
    if (dimensions == 2) return {direction[1], -direction[0], 0};
    if (dot(inlet.along, inlet.along) > 0) return unit(across(inlet.along, direction));
    std::size_t least = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (std::abs(direction[k]) < std::abs(direction[least])) least = k;
    }
    Vec3 axis{0, 0, 0};
    axis[least] = 1;
    return unit(across(axis, direction));
}

// Places -n/2 d ... n/2 d, a spacing apart, of the whole spacings that fit.
std::vector<double> positions_across(double extent, double spacing) {
    const int n = std::max(1, static_cast<int>(std::floor(extent / spacing + 1e-6)));
    std::vector<double> out;
    out.reserve(static_cast<std::size_t>(n));
    for (int k = 0; k < n; ++k) out.push_back((k - 0.5 * (n - 1)) * spacing);
    return out;
}

std::vector<std::array<double, 2>> rectangle(const scene::Inlet& inlet, double spacing, int dimensions) {
    std::vector<std::array<double, 2>> out;
    const double width = inlet.shape == scene::InletShape::disc ? 2 * inlet.radius : inlet.width;
    for (const double b : dimensions == 3 ? positions_across(inlet.height, spacing) : std::vector<double>{0}) {
        for (const double a : positions_across(width, spacing)) out.push_back({a, b});
    }
    return out;
}

// Area of the opening [m2], width in 2D [m].
double opening_of(const scene::Inlet& inlet, int dimensions) {
    const bool round = inlet.shape == scene::InletShape::disc;
    if (dimensions == 2) return round ? 2 * inlet.radius : inlet.width;
    return round ? std::numbers::pi * inlet.radius * inlet.radius : inlet.width * inlet.height;
}

// Lattice of a disc: with a point or a cell in the middle, whichever area is nearer the disc's.
std::vector<std::array<double, 2>> disc(double radius, double spacing) {
    std::vector<std::array<double, 2>> best;
    double least = std::numeric_limits<double>::infinity();
    const int cells = static_cast<int>(std::ceil(radius / spacing)) + 1;
    for (const double shift : {0.0, 0.5}) {
        std::vector<std::array<double, 2>> points;
        for (int j = -cells; j <= cells; ++j) {
            for (int i = -cells; i <= cells; ++i) {
                const double a = (i + shift) * spacing, b = (j + shift) * spacing;
                if (a * a + b * b <= radius * radius) points.push_back({a, b});
            }
        }
        const double off = std::abs(double(points.size()) * spacing * spacing - std::numbers::pi * radius * radius);
        if (off < least && !points.empty()) {
            least = off;
            best = points;
        }
    }
    return best;
}

// Layers of an inlet and what they are made of.
struct Pouring {
    flow::Layers layers;
    double volume = 0;    // of a particle [m3], in 2D [m2]
    double clearance = 0; // least distance of particles from solids [m]
    std::int64_t first_id = 0;
    std::string behind; // what is behind the opening
};

Pouring pouring_of(const Input& input) {
    const auto& domain = input.scene.domain;
    Pouring out;
    if (input.on_grid()) {
        const auto grid = grid::make_mac_grid(domain);
        const auto particles = grid::seeded_ids(grid);
        out.layers = grid::layers_of(grid);
        out.layers.buffered = grid::inlet_body_layers;
        out.volume = std::pow(out.layers.spacing, domain.dimensions);
        out.first_id = static_cast<std::int64_t>(input.scene.liquids.size()) * particles;
        out.behind = "a plug that pushes its liquid stands in " + std::to_string(out.layers.buffered) +
                     " particle spacings behind the opening";
        return out;
    }
    const auto constants = make_constants(input);
    out.layers = sph::layers_of(constants);
    out.volume = constants.rest_volume;
    out.clearance = 0.5 * domain.spacing;
    const scene::Lattice lattice{domain.spacing, domain.min, domain.max, domain.dimensions};
    out.first_id = static_cast<std::int64_t>(input.scene.liquids.size() * lattice.points());
    out.behind = "its liquid waits in " + std::to_string(out.layers.buffered) + " spacings behind the opening";
    return out;
}

flow::InletSetup make_inlet(const Input& input, const scene::Inlet& inlet, const Pouring& pouring) {
    const auto& domain = input.scene.domain;
    const double spacing = pouring.layers.spacing;
    flow::InletSetup out;
    const auto liquid = std::ranges::find(input.scene.liquids, inlet.liquid, &scene::Liquid::name);
    out.liquid = static_cast<int>(liquid - input.scene.liquids.begin());
    out.viscosity = inflow_viscosity(*liquid, inlet.centre);
    out.centre = inlet.centre;
    out.direction = unit(inlet.direction);
    out.round = inlet.shape == scene::InletShape::disc && domain.dimensions == 3;
    auto positions = out.round ? disc(inlet.radius, spacing) : rectangle(inlet, spacing, domain.dimensions);
    // Points as far apart as their number needs to cover the opening, and layers as much nearer: neither density nor flow depends on how a
    // lattice fits into it.
    const double opening = opening_of(inlet, domain.dimensions);
    const double cover =
        positions.empty() ? 1 : opening / (double(positions.size()) * std::pow(spacing, domain.dimensions - 1));
    const double stretch = domain.dimensions == 3 ? std::sqrt(cover) : cover;
    for (auto& [a, b] : positions) a *= stretch, b *= stretch;
    out.step = spacing / cover;
    out.along = width_of(inlet, out.direction, domain.dimensions);
    const Vec3& first = out.along;
    const Vec3 second = cross(out.direction, first);
    for (const auto& [a, b] : positions) {
        Vec3 point;
        for (std::size_t k = 0; k < 3; ++k) point[k] = a * first[k] + b * second[k];
        out.points.push_back(point);
    }
    out.speed = inlet.velocity > 0 ? inlet.velocity : inlet.flow_rate / opening;
    out.start = inlet.start;
    out.end = inlet.end;
    return out;
}
} // namespace

// A box that reaches an open side goes on beyond it: it takes what leaves there.
flow::OutletSetup make_outlet(const scene::Outlet& outlet, const scene::Domain& domain) {
    flow::OutletSetup out{
        outlet.shape == scene::OutletShape::box, outlet.min, outlet.max, outlet.point, unit(outlet.normal)};
    constexpr double far = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < 3; ++k) {
        const auto is_open = [&](std::size_t side) { return domain.faces[side].kind == scene::BoundaryKind::open; };
        if (is_open(2 * k) && out.min[k] <= domain.min[k]) out.min[k] = -far;
        if (is_open(2 * k + 1) && out.max[k] >= domain.max[k]) out.max[k] = far;
    }
    return out;
}

flow::InflowSetup make_inflow(const Input& input) {
    flow::InflowSetup out;
    if (input.scene.inlets.empty() && input.scene.outlets.empty()) return out;
    const auto pouring = pouring_of(input);
    for (const auto& inlet : input.scene.inlets) out.inlets.push_back(make_inlet(input, inlet, pouring));
    for (const auto& outlet : input.scene.outlets) {
        out.outlets.push_back(make_outlet(outlet, input.scene.domain));
    }
    out.first_id = pouring.first_id;
    return out;
}

namespace {
// Positions of the particles of an inlet until they have passed it, or its plug.
std::vector<Vec3> buffered_positions(const flow::InletSetup& inlet, const flow::Layers& layers) {
    std::vector<Vec3> out;
    for (int layer = 0; layer < layers.buffered; ++layer) {
        for (const auto& point : inlet.points) {
            Vec3 x = inlet.centre;
            for (std::size_t k = 0; k < 3; ++k)
                x[k] += point[k] - (layer + 0.5) * flow::step_of(inlet, layers) * inlet.direction[k];
            out.push_back(x);
        }
    }
    return out;
}

bool in_domain(const scene::Domain& domain, double clearance, const Vec3& x) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(domain.dimensions); ++k) {
        const auto gap = [&](std::size_t side) {
            return domain.faces[side].kind == scene::BoundaryKind::wall ? clearance : 0;
        };
        if (x[k] < domain.min[k] + gap(2 * k) || x[k] > domain.max[k] - gap(2 * k + 1)) return false;
    }
    return true;
}

bool in_outlet(const flow::OutletSetup& outlet, const Vec3& x, int dimensions) {
    if (!outlet.box)
        return dot({x[0] - outlet.point[0], x[1] - outlet.point[1], x[2] - outlet.point[2]}, outlet.normal) < 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(dimensions); ++k) {
        if (x[k] < outlet.min[k] || x[k] > outlet.max[k]) return false;
    }
    return true;
}

bool touch(const std::vector<Vec3>& one, const std::vector<Vec3>& other, double distance) {
    return std::ranges::any_of(one, [&](const Vec3& a) {
        return std::ranges::any_of(other, [&](const Vec3& b) {
            const Vec3 apart{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
            return dot(apart, apart) < distance * distance;
        });
    });
}

class InletCheck {
public:
    InletCheck(const Input& input, const Geometry& geometry, std::vector<Diagnostic>& problems)
        : input_(input), geometry_(geometry), problems_(problems), pouring_(pouring_of(input)),
          setup_(make_inflow(input)) {
        for (const auto& inlet : setup_.inlets) positions_.push_back(buffered_positions(inlet, pouring_.layers));
    }

    void check(std::size_t q) {
        const auto& scene = input_.scene;
        const double d = pouring_.layers.spacing, clearance = pouring_.clearance * (1 - 1e-6);
        const auto& behind = pouring_.behind;
        if (setup_.inlets[q].points.empty()) {
            complain(
                q, "is smaller than a particle", "nothing would flow in", "make it larger, or refine domain.spacing");
            return;
        }
        if (any(q, [&](const Vec3& x) { return !in_domain(scene.domain, clearance, x); })) {
            complain(q, "reaches outside of the domain", behind, "move it, or enlarge domain.min and domain.max");
        }
        for (std::size_t b = 0; b < geometry_.bodies.size(); ++b) {
            const auto& body = geometry_.bodies[b];
            if (any(q, [&](const Vec3& x) { return body.distance(x) < clearance; })) {
                complain(q, "is inside bodies." + scene.bodies[b].name, behind,
                    "move one of the two, or make the body hollow");
            }
        }
        for (std::size_t l = 0; l < geometry_.liquids.size(); ++l) {
            const auto inside = [&](const Vec3& x) {
                return std::ranges::any_of(
                    geometry_.liquids[l], [&](const auto& region) { return region.distance(x) < 0; });
            };
            if (any(q, inside)) {
                complain(q, "is where liquids." + scene.liquids[l].name + " is at the start", behind,
                    "leave that room out of the liquid's shapes");
            }
        }
        for (std::size_t o = 0; o < setup_.outlets.size(); ++o) {
            if (any(q, [&](const Vec3& x) { return in_outlet(setup_.outlets[o], x, scene.domain.dimensions); })) {
                complain(q, "is inside outlets." + scene.outlets[o].name, behind, "move one of the two");
            }
        }
        for (std::size_t other = 0; other < q; ++other) {
            if (touch(positions_[q], positions_[other], 0.9 * d)) {
                complain(q, "touches inlets." + scene.inlets[other].name, behind, "move one of the two");
            }
        }
    }

private:
    template <class Condition>
    bool any(std::size_t q, const Condition& condition) const {
        return std::ranges::any_of(positions_[q], condition);
    }
    void complain(std::size_t q, const std::string& what, const std::string& why, const std::string& cure) {
        const auto& inlet = input_.scene.inlets[q];
        problems_.push_back({inlet.where, "inlets." + inlet.name + " " + what, why, cure});
    }

    const Input& input_;
    const Geometry& geometry_;
    std::vector<Diagnostic>& problems_;
    Pouring pouring_;
    flow::InflowSetup setup_;
    std::vector<std::vector<Vec3>> positions_;
};
} // namespace

void check_inflow(const Input& input, const Geometry& geometry, std::vector<Diagnostic>& problems) {
    const auto& inlets = input.scene.inlets;
    for (const auto& inlet : inlets) {
        const bool plane = input.scene.domain.dimensions == 2;
        if (plane && inlet.direction[2] != 0) {
            problems.push_back({inlet.where, "inlets." + inlet.name + ".direction must lie in the plane",
                "the scene is plane", "write for instance direction: [0, -1]"});
            return;
        }
        const Vec3 direction = unit(inlet.direction), left = across(inlet.along, direction);
        if (dot(inlet.along, inlet.along) > 0 && dot(left, left) < 1e-6 * dot(inlet.along, inlet.along)) {
            problems.push_back({inlet.where, "inlets." + inlet.name + ".along must not be along its direction",
                "it is the direction of the width of the opening", "give another one"});
            return;
        }
    }
    if (inlets.empty()) return;
    InletCheck check(input, geometry, problems);
    for (std::size_t q = 0; q < inlets.size(); ++q) check.check(q);
    if (input.method.pressure.solver == sph::PressureSolver::dfsph) {
        problems.push_back({inlets.front().where, "inlets cannot go with method.pressure.solver: dfsph",
            "it is there to compare with and does not know them", "write another solver"});
    }
    if (input.method.pressure.corrections > 0) {
        problems.push_back({inlets.front().where, "inlets cannot go with method.pressure.corrections",
            "they would press what waits behind an opening", "leave the corrections out"});
    }
}

std::vector<std::string> inflow_notes(const Input& input) {
    std::vector<std::string> notes;
    const double d = particle_spacing(input);
    for (const auto& inlet : input.scene.inlets) {
        double extent = 2 * inlet.radius;
        if (inlet.shape == scene::InletShape::rectangle) {
            extent = input.scene.domain.dimensions == 3 ? std::min(inlet.width, inlet.height) : inlet.width;
        }
        if (extent >= fine_opening * d) continue;
        const auto [given, bound] = tell_apart(extent / d, fine_opening);
        notes.push_back("inlets." + inlet.name + ": its opening is " + given +
                        " particles wide; what flows through fewer than " + bound +
                        " is not resolved: refine domain.spacing");
    }
    return notes;
}

double flow_of(const Input& input, const flow::InletSetup& inlet) {
    const auto pouring = pouring_of(input);
    return inlet.speed * double(inlet.points.size()) * pouring.volume / flow::step_of(inlet, pouring.layers);
}

std::uint64_t inflow_particles(const Input& input, const flow::InletSetup& inlet) {
    auto layers = pouring_of(input).layers;
    if (input.on_grid()) layers.buffered = 0; // behind the opening there are none
    return static_cast<std::uint64_t>(flow::layers_until(inlet, layers, input.scene.time.end)) * inlet.points.size();
}

std::uint64_t inflow_particles(const Input& input) {
    std::uint64_t sum = 0;
    for (const auto& inlet : make_inflow(input).inlets) sum += inflow_particles(input, inlet);
    return sum;
}

} // namespace treacle::app
