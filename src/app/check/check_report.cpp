#include "app/check/check_report.hpp"

#include "app/input/table_text.hpp"
#include "app/setup/bodies.hpp"
#include "app/setup/body_checks.hpp"
#include "app/setup/build_scene.hpp"
#include "app/setup/estimates.hpp"
#include "app/setup/inflow.hpp"
#include "base/text/text.hpp"

#include <cmath>

namespace treacle::app {

namespace {

// Above it a fraction of thin liquid is more than the rounding of edges and curved faces to the lattice.
constexpr double notable_thin_fraction = 0.2;

// Share of a surface where a solid is thinner than the spacing that is more than edges, as for meshes.
constexpr double notable_thin_surface = 0.01;

class Report {
public:
    explicit Report(const CheckedScene& scene)
        : at_(scene),
          estimates_(estimate_run(scene.input, scene.geometry, scene.preview.liquid_count, scene.preview.solid_count)) {
    }

    std::vector<std::string> lines() {
        domain();
        liquids();
        inflow();
        bodies();
        particles();
        steps();
        numbers();
        warnings();
        return std::move(lines_);
    }

private:
    void heading(const std::string& text) { lines_.push_back(text); }
    void row(const std::string& name, const std::string& text) { lines_.push_back(label(name) + text); }
    void warn(const std::string& text) { warnings_.push_back(text); }
    const scene::Scene& scene() const { return at_.input.scene; }

    void domain();
    void liquids();
    void inflow();
    void bodies();
    void meshes(const scene::SolidRegion& region, const std::string& owner);
    void thickness(const scene::Shape& shape, const scene::SolidRegion& region, const std::string& owner);
    void particles();
    void steps();
    void numbers();
    void warnings();

    CheckedScene at_;
    Estimates estimates_;
    std::vector<std::string> lines_, warnings_;
};

std::string edges(const Vec3& min, const Vec3& max, int dimensions) {
    std::string out;
    for (std::size_t k = 0; k < static_cast<std::size_t>(dimensions); ++k) {
        out += (k ? " x " : "") + short_number(max[k] - min[k]);
    }
    return out + " m";
}

std::string side_text(const scene::Face& face) {
    if (face.kind == scene::BoundaryKind::open) return face.outflow ? "open, liquid may leave" : "open";
    if (face.kind == scene::BoundaryKind::periodic) return "periodic";
    std::string out = face.slip == scene::Slip::no_slip ? "no-slip wall" : "free-slip wall";
    if (face.slip == scene::Slip::slip_length)
        out = "wall with a slip length of " + short_number(face.slip_length) + " m";
    const auto& v = face.velocity;
    if (v == Vec3{0, 0, 0}) return out;
    return out + " that moves at (" + short_number(v[0]) + ", " + short_number(v[1]) + ", " + short_number(v[2]) +
           ") m/s";
}

std::string volume_text(double volume, int dimensions) {
    if (!std::isfinite(volume)) return "unbounded";
    return short_number(volume) + (dimensions == 3 ? " m3" : " m2");
}

void Report::domain() {
    const auto& domain = scene().domain;
    heading("scene: " + at_.path.string() + (scene().title.empty() ? "" : ", " + scene().title));
    row("domain",
        edges(domain.min, domain.max, domain.dimensions) + ", spacing " + short_number(domain.spacing) + " m");
    const auto names = load_names(at_.input);
    for (std::size_t k = 0; k < 2 * static_cast<std::size_t>(domain.dimensions); ++k) {
        row(names[k], side_text(domain.faces[k]));
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(domain.dimensions); ++k) {
        const auto is_wall = [&](std::size_t side) { return domain.faces[side].kind == scene::BoundaryKind::wall; };
        if (is_wall(2 * k) && is_wall(2 * k + 1) && !at_.geometry.lattice.fits(static_cast<int>(k))) {
            warn(std::string("domain: its length in ") + "xyz"[k] +
                 " is no multiple of the spacing: liquid that touches both sides leaves a gap at one of them");
        }
    }
}

void Report::meshes(const scene::SolidRegion& region, const std::string& owner) {
    for (const auto& report : region.meshes()) {
        row("mesh of " + owner, report.path);
        row("", "closed, " + std::to_string(report.components) + (report.components == 1 ? " part, " : " parts, ") +
                    grouped(report.triangles) + " triangles, " + edges(report.bounds.min, report.bounds.max, 3) +
                    ", volume " + volume_text(report.volume, 3));
        for (const auto& note : report.notes()) row("", note);
        if (report.thickness_p01 < scene().domain.spacing) {
            const auto [given, spacing] = tell_apart(report.thickness_p01, scene().domain.spacing);
            warn(owner + ": its mesh is in places thinner than the spacing (" + given + " m, " + spacing +
                 " m): refine domain.spacing or thicken it");
        }
    }
}

void Report::thickness(const scene::Shape& shape, const scene::SolidRegion& region, const std::string& owner) {
    if (shape.parts.empty() && !shape.clip) return;
    const double thin = thin_surface(region, at_.geometry, scene().domain.spacing);
    if (thin <= notable_thin_surface) return;
    warn(owner + ": " + short_number(std::round(100 * thin)) +
         " % of its surface is where it is thinner than the spacing: refine domain.spacing or thicken it");
}

void Report::liquids() {
    heading("liquids");
    for (std::size_t i = 0; i < scene().liquids.size(); ++i) {
        const auto& liquid = scene().liquids[i];
        const std::string viscosity =
            liquid.varies() ? "up to " + short_number(largest_viscosity(liquid)) : short_number(liquid.viscosity);
        row(liquid.name, short_number(liquid.density) + " kg/m3, " + viscosity + " Pa s");
        for (const auto& transfer : at_.input.transfers) {
            if (transfer.index != i) continue;
            for (const auto& line : describe(transfer)) row("", line);
        }
        std::uint64_t count = 0;
        for (const int which : at_.preview.liquid.liquids) count += which == static_cast<int>(i);
        const double d = at_.preview.lattice.spacing;
        const int dimensions = scene().domain.dimensions;
        double shapes = 0;
        for (const auto& region : at_.geometry.liquids[i]) shapes += region.volume();
        const auto filled = volume_text(static_cast<double>(count) * std::pow(d, dimensions), dimensions);
        const bool exact = at_.preview.coarsening == 1; // else the particles of the preview are fewer
        row("", "its shapes hold " + volume_text(shapes, dimensions) +
                    (exact ? ", its particles fill " + filled : std::string()));
        const double particles = static_cast<double>(count) * std::pow(at_.preview.coarsening, dimensions);
        const double volume = at_.input.on_grid() ? std::pow(particle_spacing(at_.input), dimensions)
                                                  : make_constants(at_.input).rest_volume;
        const double mass = particles * liquid.density * volume;
        row("", (exact ? "" : "about ") + grouped(static_cast<std::uint64_t>(particles)) + " particles, " +
                    short_number(mass) + (dimensions == 3 ? " kg" : " kg/m"));
        for (std::size_t k = 0; k < liquid.shapes.size(); ++k) {
            const auto& region = at_.geometry.liquids[i][k];
            meshes(region, "liquids." + liquid.name);
            thickness(liquid.shapes[k], region, "liquids." + liquid.name);
        }
    }
}

void Report::inflow() {
    const auto inflow = make_inflow(at_.input);
    if (inflow.inlets.empty()) return;
    heading("inlets");
    for (std::size_t q = 0; q < inflow.inlets.size(); ++q) {
        const auto& given = scene().inlets[q];
        const auto& inlet = inflow.inlets[q];
        const bool space = scene().domain.dimensions == 3;
        row(given.name, given.liquid + ", " + short_number(flow_of(at_.input, inlet)) + (space ? " m3/s" : " m2/s") +
                            " at " + short_number(inlet.speed) + " m/s, " + std::to_string(inlet.points.size()) +
                            " particles across");
        row("", "from " + short_number(inlet.start) + " s to " +
                    (inlet.end > 0 ? short_number(inlet.end) + " s" : std::string("the end")) + ", " +
                    grouped(inflow_particles(at_.input, inlet)) + " particles by the end");
    }
}

void Report::bodies() {
    if (!scene().bodies.empty()) heading("bodies");
    for (std::size_t i = 0; i < scene().bodies.size(); ++i) {
        const auto& body = scene().bodies[i];
        const auto& region = at_.geometry.originals[i];
        const auto dynamic = body.kind == scene::BodyKind::dynamic;
        if (body.kind == scene::BodyKind::kinematic) row(body.name, "kinematic");
        if (dynamic) {
            row(body.name, "dynamic, " + short_number(density_of(body, region)) + " kg/m3, " +
                               short_number(density_of(body, region) / scene().liquids.front().density) +
                               " times the density of " + scene().liquids.front().name);
        }
        row(moves(body) ? "" : body.name, std::string(body.slip == scene::Slip::no_slip ? "no-slip" : "free-slip") +
                                              ", volume " + volume_text(region.volume(), scene().domain.dimensions));
        meshes(region, "bodies." + body.name);
        thickness(body.shape, region, "bodies." + body.name);
    }
    if (!scene().joints.empty()) heading("joints");
    for (const auto& joint : scene().joints) row(joint.name, describe(joint));
    if (at_.preview.thin_solid > 0) warn(thin_note(at_.preview.thin_solid));
}

void Report::particles() {
    const std::string about = at_.preview.coarsening > 1 ? "about " : "";
    heading("particles");
    row("liquid", about + grouped(at_.preview.liquid_count));
    if (estimates_.poured > 0)
        row("", "and up to " + grouped(static_cast<std::uint64_t>(estimates_.poured)) + " more by the end");
    if (!at_.input.on_grid()) row("solid", about + grouped(at_.preview.solid_count));
    const auto per_rank = estimates_.bytes / at_.ranks;
    row("memory", "about " + format_bytes(static_cast<std::uint64_t>(estimates_.bytes)) + " in all, " +
                      format_bytes(static_cast<std::uint64_t>(per_rank)) + " on each of " + std::to_string(at_.ranks) +
                      (at_.ranks == 1 ? " rank" : " ranks"));
}

std::string step_text(double step) { return std::isfinite(step) ? short_number(step) + " s" : "no limit"; }

void Report::steps() {
    const auto& time = scene().time;
    heading("time");
    row("end", short_number(time.end) + " s");
    row("limit by speed", step_text(estimates_.courant_step) + " at " + short_number(estimates_.speed) + " m/s, " +
                              (estimates_.initial_speed < estimates_.speed ? "sqrt(g H)" : "as at the start"));
    row("limit by gravity", step_text(estimates_.gravity_step));
    const double factor = sph::time_step_factor(liquid_materials(at_.input));
    if (factor < 1)
        row("", "both with " + short_number(factor) + " of time.cfl, the root of the ratio of the densities");
    if (std::isfinite(estimates_.capillary_step)) row("limit by capillarity", step_text(estimates_.capillary_step));
    row("limit by viscosity", std::isfinite(estimates_.viscous_step) ? step_text(estimates_.viscous_step)
                                                                     : "none, no viscosity or an implicit one");
    const bool fixed = time.rule == scene::StepRule::fixed;
    row("step", (fixed ? "fixed, " : "about ") + step_text(estimates_.step) + ", " +
                    (std::isfinite(estimates_.steps) ? grouped(static_cast<std::uint64_t>(estimates_.steps)) : "few") +
                    " steps");
    if (fixed && time.step > estimates_.courant_step) {
        warn("time.step: particles at " + short_number(estimates_.speed) +
             " m/s move more than time.cfl spacings in a step");
    }
    if (!fixed && estimates_.step < time.min_step) {
        warn("time.min_step: the first steps are expected to be smaller, and the run would end with exit "
             "code 3");
    }
    if (estimates_.viscous_step < 0.1 * std::min(estimates_.courant_step, estimates_.gravity_step)) {
        warn("liquids: the explicit viscosity makes the time step " +
             short_number(std::min(estimates_.courant_step, estimates_.gravity_step) / estimates_.viscous_step) +
             " times smaller than the motion asks for");
    }
}

void Report::numbers() {
    heading("dimensionless numbers");
    row("H, U", short_number(estimates_.length) + " m, " + short_number(estimates_.speed) + " m/s");
    for (const auto& number : dimensionless_numbers(at_.input, estimates_)) {
        row(number.name, short_number(number.value) + "  (" + number.formula + ")");
    }
}

void Report::warnings() {
    const auto fractions = thin_fractions(at_.preview, scene().liquids.size());
    for (std::size_t i = 0; i < fractions.size(); ++i) {
        if (fractions[i] <= notable_thin_fraction) continue;
        warn("liquids." + scene().liquids[i].name + ": " + short_number(std::round(100 * fractions[i])) +
             " % of it is thinner than three spacings: refine domain.spacing");
    }
    for (const auto& note : at_.geometry.notes) warn(note);
    for (const auto& note : body_warnings(at_.input, at_.geometry)) warn(note);
    for (const auto& note : method_notes(at_.input)) warn(note);
    for (const auto& note : inflow_notes(at_.input)) warn(note);
    for (const auto& text : warnings_) lines_.push_back("warning: " + text);
    if (warnings_.empty()) lines_.emplace_back("no warnings");
}

} // namespace

std::vector<std::string> check_report(const CheckedScene& scene) { return Report(scene).lines(); }

} // namespace treacle::app
