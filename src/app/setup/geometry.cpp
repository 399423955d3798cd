#include "app/setup/geometry.hpp"

#include "app/input/table_text.hpp"
#include "app/setup/bodies.hpp"
#include "app/setup/body_checks.hpp"
#include "app/setup/inflow.hpp"
#include "app/setup/symmetry.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "grid/geometry/seeding.hpp"
#include "scene/shapes/clip.hpp"
#include "sph/forces/density.hpp"
#include "sph/forces/forces.hpp"
#include "sph/solids/slip_lattice.hpp"
#include "sph/surface_tension/surface_tension.hpp"
#include "sph/viscosity/operator/near_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace treacle::app {

namespace {
scene::Side side_of(const scene::Face& face) {
    switch (face.kind) {
    case scene::BoundaryKind::wall: return scene::Side::wall;
    case scene::BoundaryKind::open: return scene::Side::open;
    case scene::BoundaryKind::periodic: return scene::Side::periodic;
    }
    return scene::Side::wall;
}

bool lies_within(const scene::Bounds& bounds, const scene::Domain& domain) {
    bool fits = true;
    for (std::size_t k = 0; k < static_cast<std::size_t>(domain.dimensions); ++k) {
        fits = fits && bounds.min[k] >= domain.min[k] && bounds.max[k] <= domain.max[k];
    }
    return fits;
}

// The solid of a shape, cut at the domain where its options state that; `owner` for the note.
scene::SolidRegion make_solid(
    const scene::Shape& shape, const scene::Domain& domain, const std::string& owner, std::vector<std::string>& notes) {
    scene::SolidRegion whole(shape, domain.dimensions);
    if (!shape.clip) return whole;
    if (lies_within(whole.bounds(), domain)) return whole;
    scene::SolidRegion part(scene::clipped(shape, {domain.min, domain.max}), domain.dimensions);
    const std::string unit = domain.dimensions == 3 ? " m3" : " m2";
    auto note = owner + " is cut at the domain (clip): " + short_number(part.volume()) + unit + " are left";
    if (std::isfinite(whole.volume())) {
        const double percent = 100 * std::max(0.0, 1 - part.volume() / whole.volume());
        note += ", " + short_number(std::round(10 * percent) / 10) + " % of its " + short_number(whole.volume()) +
                unit + " are cut off";
    }
    notes.push_back(note);
    return part;
}

// Part of the shape on this side of the domain's mirrors.
scene::Shape cut_at_mirrors(const scene::Shape& shape, const scene::Domain& domain) {
    if (domain.mirrors().empty()) return shape;
    scene::Bounds kept{domain.min, domain.max};
    for (std::size_t k = 0; k < 3; ++k) { // what is farther away is reported in any case
        const double length = domain.max[k] - domain.min[k];
        kept.min[k] -= length;
        kept.max[k] += length;
    }
    for (const auto& mirror : domain.mirrors()) {
        const auto k = mirror.axis;
        (domain.faces[2 * k].mirror ? kept.min : kept.max)[k] = mirror.position;
    }
    auto out = scene::clipped(shape, kept);
    out.clip = shape.clip;
    return out;
}

// Throws InputError for shapes without end.
Vec3 pivot_of(const scene::Liquid& liquid, const scene::Regions& regions) {
    if (!liquid.sheared()) return {0, 0, 0};
    if (liquid.pivot) return *liquid.pivot;
    if (!std::ranges::all_of(regions, [](const auto& region) { return std::isfinite(region.volume()); })) {
        throw InputError({liquid.where, "liquids." + liquid.name + ".pivot is missing",
            "its shapes have no end, and no centre that it could turn about", "write pivot: {point: [0, 0, 0]}"});
    }
    return scene::moments_of(regions).centre;
}

} // namespace

sph::WallSetup wall_setup(const Input& input) {
    const auto& domain = input.scene.domain;
    return {input.method.kernel, domain.dimensions, input.method.support_ratio * domain.spacing, domain.spacing,
        domain.spacing};
}

double solid_offset(const Input& input) {
    return sph::equilibrium_wall_distance(wall_setup(input), input.method.density) - input.scene.domain.spacing / 2;
}

double particle_spacing(const Input& input) {
    return input.scene.domain.spacing / (input.on_grid() ? grid::particles_per_axis : 1);
}

Geometry build_geometry(const Input& input) {
    const auto& domain = input.scene.domain;
    Geometry out;
    out.notes = input.notes;
    out.lattice = {particle_spacing(input), domain.min, domain.max, domain.dimensions};
    if (!input.on_grid()) out.offset = solid_offset(input);
    for (const auto& liquid : input.scene.liquids) {
        auto& regions = out.liquids.emplace_back();
        for (const auto& shape : liquid.shapes) {
            regions.push_back(make_solid(cut_at_mirrors(shape, domain), domain, "liquids." + liquid.name, out.notes));
        }
        out.pivots.push_back(pivot_of(liquid, regions));
        auto& parts = out.viscosity_regions.emplace_back();
        for (const auto& part : liquid.viscosity_regions) parts.emplace_back(part.shape, domain.dimensions);
    }
    for (const auto& body : input.scene.bodies) {
        out.originals.push_back(make_solid(body.shape, domain, "bodies." + body.name, out.notes));
        out.spans.push_back(spanned_axes(body, out.originals.back(), domain));
        const bool spans = std::ranges::any_of(out.spans.back(), [](bool along) { return along; });
        if (spans)
            out.bodies.emplace_back(with_images(body.shape, out.spans.back(), domain, out.offset), domain.dimensions);
        else
            out.bodies.push_back(out.originals.back());
        out.moving.push_back(moves(body) ? 1 : 0);
    }
    out.walls.lattice = out.lattice;
    for (std::size_t k = 0; k < 6; ++k) out.walls.sides[k] = side_of(domain.faces[k]);
    if (domain.dimensions == 2) out.walls.sides[4] = out.walls.sides[5] = scene::Side::open;
    if (input.on_grid()) return out;
    out.walls.outset = out.offset;
    return out;
}

scene::SurfaceSampling body_sampling(const Geometry& geometry, std::size_t body) {
    const auto& lattice = geometry.lattice;
    scene::SurfaceSampling sampling{
        periodic_spacing(lattice.spacing, geometry.spans[body], lattice.min, lattice.max), geometry.offset, {}};
    const bool whole = geometry.moving[body] != 0 && geometry.bodies[body].closed();
    for (std::size_t k = 0; k < 3; ++k) {
        if (whole && !geometry.spans[body][k]) continue;
        sampling.clip.min[k] = geometry.lattice.min[k];
        sampling.clip.max[k] = geometry.lattice.max[k];
        if (geometry.spans[body][k]) sampling.clip.max[k] -= 1e-9 * geometry.lattice.spacing; // the images' first point
    }
    if (whole) return sampling;
    for (std::size_t k = 0; k < static_cast<std::size_t>(geometry.lattice.dimensions); ++k) {
        const double offset = std::max(0.0, geometry.offset);
        if (geometry.walls.sides[2 * k] == scene::Side::wall) sampling.clip.min[k] -= offset;
        if (geometry.walls.sides[2 * k + 1] == scene::Side::wall) sampling.clip.max[k] += offset;
    }
    return sampling;
}

double thin_surface(const scene::SolidRegion& region, const Geometry& geometry, double spacing) {
    const auto samples = scene::sample_surface(region, {spacing, 0, {geometry.lattice.min, geometry.lattice.max}});
    constexpr int probes = 4;
    std::size_t thin = 0;
    for (std::size_t i = 0; i < samples.positions.size(); ++i) {
        const auto behind = [&](double depth) {
            Vec3 x = samples.positions[i];
            for (std::size_t k = 0; k < 3; ++k) x[k] -= depth * samples.normals[i][k];
            return region.distance(x);
        };
        // From an edge the one face's normal runs along the other face.
        if (std::abs(behind(0.02 * spacing)) < 1e-3 * spacing && std::abs(behind(0.05 * spacing)) < 1e-3 * spacing)
            continue;
        bool through = false;
        for (int q = 1; q <= probes && !through; ++q) through = behind(spacing * (1 - 1e-6) * q / probes) > 0;
        thin += through ? 1 : 0;
    }
    return samples.positions.empty() ? 0 : double(thin) / double(samples.positions.size());
}

std::string thin_note(std::size_t samples) {
    return "bodies: " + std::to_string(samples) +
           " solid particles are where a body is too thin for a layer on each side; liquid may feel it from behind";
}

scene::VolumeFill liquid_fill(const Input& input, const Geometry& geometry, const scene::Lattice& lattice) {
    const bool spreads = !input.on_grid() && input.method.pressure.recovers_positions();
    return {geometry.liquids, geometry.bodies, spreads ? 0 : (0.5 - 1e-9) * lattice.spacing, lattice, {}};
}

ParticleCounts estimate_particles(const Input& input, const Geometry& geometry) {
    ParticleCounts counts;
    for (const auto count : scene::estimate_liquid_counts(liquid_fill(input, geometry, geometry.lattice)))
        counts.liquid += count;
    if (input.on_grid()) return counts; // whose solids are no particles
    counts.solid = scene::count_domain_walls(geometry.walls);
    for (std::size_t b = 0; b < geometry.bodies.size(); ++b) {
        counts.solid += scene::estimate_surface_count(geometry.bodies[b], body_sampling(geometry, b));
    }
    return counts;
}

double bytes_per_particle(const Input& input) {
    // Bytes of a full cell: levels and shares of its parts, faces, the systems of the pressure and of three faces; then
    // the state.
    if (input.on_grid()) return 300 + 6000 * std::pow(grid::particles_per_axis, -input.scene.domain.dimensions);
    const auto& domain = input.scene.domain;
    const auto lattice = sph::compute_lattice_sums(
        input.method.kernel, domain.dimensions, input.method.support_ratio * domain.spacing, domain.spacing);
    // State, work arrays and solver vectors; per neighbour the list, the matrix and half of it factorised.
    return 500 + 22.0 * (lattice.neighbours + 1);
}

namespace {
// Memory that can still be allocated on this machine [bytes]; 0 when unknown.
double available_memory() {
    std::ifstream file("/proc/meminfo");
    std::string key;
    double kilobytes = 0;
    while (file >> key >> kilobytes) {
        if (key == "MemAvailable:") return 1024 * kilobytes;
        file.ignore(256, '\n');
    }
    return 0;
}

std::string point_text(const Vec3& x) {
    std::ostringstream out;
    out << "(" << x[0] << ", " << x[1] << ", " << x[2] << ") m";
    return out.str();
}

void check_overlaps(const Input& input, const Geometry& geometry, std::vector<Diagnostic>& problems) {
    for (std::size_t k = 0; k < geometry.liquids.size(); ++k) {
        const auto& liquid = input.scene.liquids[k];
        const auto outside = scene::find_outside(geometry.liquids[k], geometry.lattice);
        if (outside.count > 0) {
            problems.push_back({liquid.where,
                "liquids." + liquid.name + " reaches outside of the domain, as at " + point_text(outside.example),
                std::to_string(outside.count) + " of its " + std::to_string(outside.total) +
                    " particles would start there",
                "move or shrink its shapes, or enlarge domain.min and domain.max"});
        }
        for (std::size_t b = 0; b < geometry.bodies.size() && !liquid.subtract_bodies; ++b) {
            const auto overlap =
                scene::find_overlap(geometry.liquids[k], scene::Regions{geometry.bodies[b]}, geometry.lattice);
            if (overlap.count == 0) continue;
            problems.push_back({liquid.where,
                "liquids." + liquid.name + " overlaps bodies." + input.scene.bodies[b].name + ", as at " +
                    point_text(overlap.example),
                std::to_string(overlap.count) + " of its " + std::to_string(overlap.total) +
                    " particles would start inside the solid",
                "move one of the two, make the liquid of shapes around the body, or set its "
                "subtract_bodies to true"});
        }
    }
}
} // namespace

namespace {
// With as many digits as distinguish them.
std::pair<std::string, std::string> memory_texts(double needed, double available) {
    std::pair out(
        format_bytes(static_cast<std::uint64_t>(needed)), format_bytes(static_cast<std::uint64_t>(available)));
    if (out.first != out.second) return out;
    const auto [most, spare] = tell_apart(needed, available);
    return {most + " B", spare + " B"};
}
} // namespace

void validate_geometry(const Input& input, const Geometry& geometry, const Comm& comm) {
    std::vector<Diagnostic> problems;
    check_overlaps(input, geometry, problems);
    check_bodies(input, geometry, problems);
    check_inflow(input, geometry, problems);
    check_symmetry(input, problems);
    auto counts = estimate_particles(input, geometry);
    counts.liquid += inflow_particles(input);
    if (counts.liquid == 0) {
        problems.push_back({input.scene.liquids.front().where, "the scene has no liquid particle",
            "no point of the particle lattice lies in its liquids",
            "enlarge the liquid's shapes, or refine domain.spacing"});
    }
    const double needed = bytes_per_particle(input) * double(counts.liquid) + 200.0 * double(counts.solid);
    const double available = available_memory();
    if (available > 0 && needed > available) {
        const auto [most, spare] = memory_texts(needed, available);
        problems.push_back({input.scene.domain.where,
            "the run needs about " + most + " of memory for " + std::to_string(counts.liquid) + " liquid and " +
                std::to_string(counts.solid) + " solid particles",
            "this machine has " + spare + " to spare for its " + std::to_string(comm.size()) + " ranks",
            "enlarge domain.spacing, or use more machines"});
    }
    if (!problems.empty()) throw InputError(std::move(problems));
}

bool any_slip_length(const Input& input) {
    const auto slips = [](const auto& solid) { return solid.slip == scene::Slip::slip_length; };
    return std::ranges::any_of(input.scene.domain.faces, slips) || std::ranges::any_of(input.scene.bodies, slips);
}

sph::ViscosityIntegration viscosity_integration(const Input& input) {
    using sph::ViscosityIntegration;
    if (input.method.viscosity.integration != ViscosityIntegration::automatic)
        return input.method.viscosity.integration;
    const double viscosity = limiting_viscosity(input);
    if (viscosity == 0) return ViscosityIntegration::explicit_pairs;
    if (viscosities_vary(input) || any_slip_length(input)) return ViscosityIntegration::implicit;
    const auto& time = input.scene.time;
    const auto& g = input.scene.domain.gravity;
    const double d = input.scene.domain.spacing, pull = std::hypot(g[0], g[1], g[2]);
    double step = time.step > 0 ? time.step : time.end;
    if (time.rule != scene::StepRule::fixed && pull > 0) step = std::min(step, time.cfl * std::sqrt(d / pull));
    constexpr double margin = 4;
    return sph::viscous_step_limit(make_constants(input), viscosity) < margin * step
               ? ViscosityIntegration::implicit
               : ViscosityIntegration::explicit_pairs;
}

double viscous_step_limit(const Input& input) {
    auto options = input.method.viscosity;
    options.integration = viscosity_integration(input);
    return sph::viscous_step_limit(options, make_constants(input), limiting_viscosity(input));
}

double capillary_step_limit(const Input& input) {
    auto constants = make_constants(input);
    constants.immiscible.time_step_factor = sph::time_step_factor(liquid_materials(input));
    return sph::capillary_step_limit(
        input.method.surface_tension, constants, input.scene.liquids.front().surface_tension);
}

sph::Constants make_constants(const Input& input) {
    const auto& domain = input.scene.domain;
    sph::Constants out;
    out.dimensions = domain.dimensions;
    out.spacing = domain.spacing;
    out.support = input.method.support_ratio * domain.spacing;
    const auto lattice = sph::compute_lattice_sums(input.method.kernel, domain.dimensions, out.support, domain.spacing);
    out.rest_density = input.scene.liquids.front().density;
    out.rest_volume = lattice.volume;
    out.mass = out.rest_density * lattice.volume;
    out.number_density = lattice.number_density;
    out.laplacian_diagonal = lattice.laplacian_diagonal;
    const sph::WallSetup wall{input.method.kernel, domain.dimensions, out.support, domain.spacing, domain.spacing};
    const double viscous = sph::viscous_support(input.method, domain.spacing);
    out.wall_packing = sph::wall_packing(input.method.pressure, domain.dimensions);
    if (limiting_viscosity(input) > 0)
        out.wall_viscous_factor = sph::wall_viscous_factor(wall, input.method.density, viscous) / out.wall_packing;
    if (any_slip_length(input)) sph::measure_slip(wall, input.method.density, viscous, out);
    if (input.method.pressure.dirichlet == sph::DirichletRule::ghosts) {
        out.wall_laplacian_factor = sph::wall_laplacian_factor(wall, input.method.density);
    }
    if (input.method.pressure.wall_force == sph::WallForce::balanced) {
        out.wall_pressure_factor = sph::wall_pressure_factor(wall, input.method.density);
    }
    return out;
}

} // namespace treacle::app
