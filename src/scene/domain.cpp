#include "base/options/options.hpp"
#include "scene/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace treacle::scene {

namespace {

const std::array<std::string, 6> face_names{"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};

void declare_boundaries(Declaration& d, Domain& domain) {
    for (std::size_t i = 0; i < face_names.size(); ++i) {
        domain.faces[i].axis = static_cast<int>(i / 2);
        d.block(face_names[i], domain.faces[i],
            "The side of the domain at the " + std::string(i % 2 == 0 ? "lower" : "upper") + " end of " +
                face_names[i].substr(0, 1) + ".",
            "kind");
    }
    for (std::size_t i = 0; i < face_names.size(); i += 2) {
        const auto& low = domain.faces[i];
        const auto& high = domain.faces[i + 1];
        const bool one_sided = (low.kind == BoundaryKind::periodic) != (high.kind == BoundaryKind::periodic);
        const bool low_periodic = low.kind == BoundaryKind::periodic;
        d.check(!one_sided, face_names[low_periodic ? i + 1 : i],
            {"must be periodic as " + face_names[low_periodic ? i : i + 1] + " is",
                "what leaves one side enters at the other", "make both periodic or none"});
        d.check(!low.mirror || !high.mirror, face_names[i + 1],
            {"must not be a mirror as " + face_names[i] + " is", "between two mirrors there is no end of images",
                "leave one of them"});
        const bool plane = i == 4 && domain.dimensions == 2;
        for (const std::size_t face : {i, i + 1}) {
            d.check(!plane || domain.faces[face] == Face{}, face_names[face],
                {"must not be given", "a plane scene has no sides in z", "remove it"});
        }
    }
}

// Cells are counted in 64 bits over three axes; a longer domain is a slip of a unit anyway.
constexpr double most_spacings = 1e6;

// From the axis that is up towards x.
void tilt_gravity(Vec3& gravity, double angle, std::size_t up) {
    const double x = gravity[0], y = gravity[up];
    gravity[0] = x * std::cos(angle) - y * std::sin(angle);
    gravity[up] = x * std::sin(angle) + y * std::cos(angle);
}

void check_extent(Declaration& d, const Domain& domain) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(domain.dimensions); ++i) {
        const std::string axis(1, "xyz"[i]);
        const double length = domain.max[i] - domain.min[i];
        d.check(length > 0, "max",
            {"must be greater than min in " + axis, "the domain has no volume", "swap the corners or make it larger"});
        if (!(length > 0)) continue;
        d.check(domain.spacing <= length, "spacing",
            {"must be at most the length of the domain in " + axis, "not one particle fits", "make it smaller"});
        d.check(length / domain.spacing <= most_spacings, "spacing",
            {"must be at least a millionth of the length of the domain in " + axis,
                "cells of the size of a spacing are counted", "check the units of spacing, min and max"});
    }
}

// Leaves the upper half across each axis, whose lower side becomes a mirror.
// A plane of symmetry.
Face mirror_across(std::size_t axis, const std::string& where) {
    Face out;
    out.axis = static_cast<int>(axis);
    out.mirror = true;
    out.where = where;
    return out;
}

void halve(Declaration& d, Domain& domain, const std::vector<std::string>& axes) {
    for (const auto& name : axes) {
        const auto k = static_cast<std::size_t>(name[0] - 'x');
        auto& low = domain.faces[2 * k];
        const auto& high = domain.faces[2 * k + 1];
        d.check(k < static_cast<std::size_t>(domain.dimensions), "symmetry",
            {"must not have z", "a plane scene has none", "remove it"});
        const bool alike = low == high && low.kind != BoundaryKind::periodic && !low.mirror;
        d.check(alike, "symmetry",
            {"must not have " + name,
                face_names[2 * k] + " and " + face_names[2 * k + 1] +
                    " are periodic, mirrors, or differ, and the middle between them is no plane of symmetry",
                "make the two sides alike, or remove the axis"});
        if (!d.parsing() || !alike) continue;
        domain.min[k] += 0.5 * (domain.max[k] - domain.min[k]);
        low = mirror_across(k, high.where);
    }
}

void check_mirrors(Declaration& d, const Domain& domain) {
    for (const auto& mirror : domain.mirrors()) {
        const std::string axis(1, "xyz"[mirror.axis]);
        d.check(domain.gravity[mirror.axis] == 0, "gravity",
            {"must be 0 along " + axis, "the scene is mirrored across it, gravity too",
                "remove the symmetry in " + axis + ", or the tilt"});
    }
}

} // namespace

std::vector<MirrorPlane> Domain::mirrors() const {
    std::vector<MirrorPlane> out;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        if (faces[i].mirror) out.push_back({i / 2, i % 2 == 0 ? min[i / 2] : max[i / 2]});
    }
    return out;
}

Domain Domain::with_images() const {
    Domain out = *this;
    for (std::size_t k = 0; k < 3; ++k) {
        const double length = max[k] - min[k];
        if (faces[2 * k].mirror) out.min[k] -= length;
        if (faces[2 * k + 1].mirror) out.max[k] += length;
    }
    return out;
}

void Face::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.choice<BoundaryKind>("kind", kind,
        {{"wall", BoundaryKind::wall}, {"open", BoundaryKind::open}, {"periodic", BoundaryKind::periodic}},
        "Whether liquid stops here, leaves, or enters again at the opposite side.");
    d.boolean("outflow", outflow,
        "Whether liquid may leave through an open side, as through an outlet. Otherwise what leaves counts as lost "
        "(max_lost_fraction), but for what goes through the part of the side that a box of `outlets` reaches.");
    d.check(kind == BoundaryKind::open || !outflow, "outflow",
        {"has no effect", "the side is not open", "remove it or write kind: open"});
    d.boolean("mirror", mirror,
        "Whether the side is a plane of symmetry: a free-slip wall beyond which films, silhouettes and pictures have "
        "the mirror image of the scene. "
        "See domain.symmetry.");
    d.choice<Slip>("slip", slip,
        {{"free_slip", Slip::free_slip}, {"no_slip", Slip::no_slip}, {"slip_length", Slip::slip_length}},
        "How a wall holds viscous liquid.");
    d.number("slip_length", slip_length, unit::length, range_at_least(0),
        "With slip: slip_length, the depth behind the wall at which the velocity would be that of the wall.");
    d.number("skin_friction", skin_friction, unit::none, range_between(0, 1),
        "Coefficient c_f of turbulent flow along the wall, whose boundary layer is thinner than a particle: the "
        "shear stress is c_f / 2 times density times speed squared. 0.003 to 0.01 for water on smooth walls.");
    d.vec3("velocity", velocity, unit::velocity,
        "Velocity of a wall along itself, as that of a belt: the domain stays as it is, and the liquid that the wall "
        "holds is "
        "taken along.");
    d.check(velocity[static_cast<std::size_t>(axis)] == 0, "velocity",
        {std::string("must be 0 along ") + "xyz"[axis],
            "a side of the domain moves along itself alone, since the domain keeps its size",
            "take a kinematic body for a piston"});
    const bool still = velocity == Vec3{0, 0, 0};
    d.check(still || kind == BoundaryKind::wall, "velocity",
        {"has no effect",
            std::string("the side is ") + (kind == BoundaryKind::open ? "open" : "periodic") + " and no wall",
            "remove it or write kind: wall"});
    d.check(still || kind != BoundaryKind::wall || slip != Slip::free_slip || skin_friction > 0, "velocity",
        {"has no effect", "a free-slip wall takes nothing along", "write slip: no_slip, or give a slip length"});
    d.check(kind == BoundaryKind::wall || skin_friction == 0, "skin_friction",
        {"has no effect", "the side is not a wall", "remove it or write kind: wall"});
    d.check(slip != Slip::slip_length || slip_length > 0, "slip_length",
        {"must be > 0 with slip: slip_length", "0 is no_slip", "give a length or write slip: no_slip"});
    d.check(slip == Slip::slip_length || slip_length == 0, "slip_length",
        {"has no effect", "slip is not slip_length", "add slip: slip_length or remove it"});
    d.check(!mirror || (kind == BoundaryKind::wall && slip == Slip::free_slip && skin_friction == 0 &&
                           velocity == Vec3{0, 0, 0}),
        "mirror",
        {"must be false", "a plane of symmetry is a free-slip wall that stays", "remove what else the side has"});
    d.check(kind == BoundaryKind::wall || slip == Slip::free_slip, "slip",
        {"has no effect", "the side is not a wall", "remove it or write kind: wall"});
}

bool Domain::any_side_moves() const {
    return std::ranges::any_of(faces, [](const Face& face) { return face.velocity != Vec3{0, 0, 0}; });
}

void Domain::declare(Declaration& d) {
    d.integer("dimensions", dimensions, range_between(2, 3),
        "2 for a plane scene in x and y, where vectors have two numbers; 3 for space.");
    if (dimensions == 2) d.allow_2d_vectors();
    if (d.parsing()) gravity = dimensions == 2 ? Vec3{0, -9.81, 0} : Vec3{0, 0, -9.81};
    d.vec3("min", min, unit::length, "Lower corner.");
    d.vec3("max", max, unit::length, "Upper corner.");
    d.required("max");
    if (d.parsing() && dimensions == 2) min[2] = max[2] = 0;
    d.number("spacing", spacing, unit::length,
        range_above(0).because("it is the distance of neighbouring particles", "write for instance 5 mm"),
        "Distance of neighbouring particles, or width of the grid's cells.");
    d.required("spacing");
    if (d.parsing()) where = d.location_of("spacing");
    d.vec3("gravity", gravity, unit::acceleration, "Acceleration; in a plane scene by default [0, -9.81].");
    // Not kept: gravity holds it from here on, and effective.yaml states that.
    double tilt = 0;
    d.number("tilt", tilt, unit::angle, range_between(-std::numbers::pi / 2, std::numbers::pi / 2),
        "Angle by which the table of the scene slopes down towards x: gravity is turned by it.");
    if (d.parsing()) tilt_gravity(gravity, tilt, dimensions == 2 ? 1 : 2);
    d.block_of(
        "boundaries", [this](Declaration& inside) { declare_boundaries(inside, *this); }, "The sides of the domain.");
    // Not kept, as the tilt: min and the boundaries hold it from here on.
    std::vector<std::string> symmetry;
    d.texts("symmetry", symmetry,
        "Axes across which the scene is its own mirror image in the middle of the domain: the upper half alone is run, "
        "in half the time, and shapes are "
        "cut there; films, silhouettes and pictures have the whole. Volumes, forces and tables are of the part that is "
        "run.",
        {"x", "y", "z"});
    check_extent(d, *this);
    halve(d, *this, symmetry);
    check_mirrors(d, *this);
}

} // namespace treacle::scene
