#include "app/scene_surface.hpp"

#include "app/bodies.hpp"
#include "app/geometry.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "rigid/algebra.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

namespace treacle::app {

surface::Domain surface_domain(const Input& input) {
    const auto& domain = input.scene.domain;
    surface::Domain out;
    out.dimensions = domain.dimensions;
    out.min = domain.min;
    out.max = domain.max;
    for (std::size_t k = 0; k < 6; ++k) {
        const auto kind = domain.faces[k].kind;
        out.sides[k] = kind == scene::FaceKind::wall       ? surface::Side::wall
                       : kind == scene::FaceKind::periodic ? surface::Side::periodic
                                                           : surface::Side::open;
    }
    return out;
}

surface::Options surface_options(const Input& input) {
    surface::Options out;
    out.spacing = particle_spacing(input);
    return out;
}

namespace {
std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> out;
    std::stringstream stream(line);
    for (std::string word; std::getline(stream, word, ',');) out.push_back(word);
    return out;
}

// Rows of the table: the step, then the columns asked for.
std::vector<std::vector<double>> read_columns(const std::filesystem::path& path, const std::vector<std::string>& names) {
    std::ifstream stream(path);
    std::string line;
    if (!stream || !std::getline(stream, line)) {
        throw InputError({path.string(), "cannot be read", "it says where bodies are", "give the folder of a run that is whole"});
    }
    const auto header = split(line);
    std::vector<std::size_t> columns{0};
    for (const auto& name : names) {
        const auto at = std::find(header.begin(), header.end(), name);
        if (at == header.end()) throw InputError({path.string(), "has no column " + name, "it says where a body is", ""});
        columns.push_back(static_cast<std::size_t>(at - header.begin()));
    }
    std::vector<std::vector<double>> rows;
    while (std::getline(stream, line)) {
        const auto words = split(line);
        if (words.size() != header.size()) continue; // the row that a run is writing
        auto& row = rows.emplace_back();
        for (const auto column : columns) row.push_back(read_number(words[column]).value_or(0));
    }
    return rows;
}
} // namespace

SceneSurface::SceneSurface(const Comm& comm, const RunView& run, const surface::Options& options)
    : comm_(comm), run_(run), mesher_(comm, surface_domain(run.input), options) {
    const auto& bodies = run.input.scene.bodies;
    if (bodies.empty()) return;
    const auto geometry = build_geometry(run.input);
    const bool any = any_moves(run.input);
    const auto setup = any ? make_bodies(run.input, geometry) : rigid::BodiesSetup{};
    std::vector<std::string> names;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        auto& solid = start_.emplace_back(surface::Solid{geometry.bodies[b]});
        moving_.push_back(-1);
        if (!moves(bodies[b])) continue;
        solid.centre = setup.bodies[b].centre;
        moving_.back() = static_cast<int>(names.size());
        for (const char* what : {" position", " rotation"}) {
            const char* unit = what[1] == 'p' ? " [m]" : " [rad]";
            for (const char* axis : {" x", " y", " z"}) names.push_back(bodies[b].name + what + axis + unit);
        }
    }
    if (!names.empty()) comm.guard([&] { poses_ = read_columns(run.folder.bodies(), names); });
}

surface::Solids SceneSurface::solids_at(std::int64_t step) const {
    surface::Solids out{start_};
    const auto row = std::lower_bound(poses_.begin(), poses_.end(), static_cast<double>(step),
                                      [](const auto& one, double s) { return one[0] < s; });
    if (row == poses_.end() || (*row)[0] != static_cast<double>(step)) return out; // before the first step
    for (std::size_t b = 0; b < moving_.size(); ++b) {
        if (moving_[b] < 0) continue;
        const double* pose = row->data() + 1 + moving_[b];
        auto& solid = out.bodies[b];
        const auto turn = rigid::to_matrix(rigid::rotation_by({pose[3], pose[4], pose[5]}));
        for (std::size_t k = 0; k < 3; ++k) {
            solid.translation[k] = pose[k] - solid.centre[k];
            for (std::size_t l = 0; l < 3; ++l) solid.rotation[k][l] = turn[k][l];
        }
    }
    return out;
}

const surface::Mesh& SceneSurface::build(std::size_t frame) {
    const auto path = run_.frame(frame);
    const auto rows = io::read_frame(comm_, path);
    time_ = rows.time;
    surface::ParticleRows particles;
    particles.position = rows.positions;
    const auto reals = [&](const char* name) -> std::span<const double> {
        const auto* column = rows.find(name);
        return column ? std::span<const double>(std::get<std::vector<double>>(column->values)) : std::span<const double>();
    };
    const auto integers = [&](const char* name) -> std::span<const std::int64_t> {
        const auto* column = rows.find(name);
        return column ? std::span<const std::int64_t>(std::get<std::vector<std::int64_t>>(column->values))
                      : std::span<const std::int64_t>();
    };
    particles.id = integers("id");
    if (!rows.find("id")) throw InputError({path.string(), "has no field id", "particles are ordered by it", ""});
    particles.velocity = reals("velocity");
    particles.pressure = reals("pressure");
    particles.liquid = integers("liquid");
    solids_ = solids_at(rows.step);
    return mesher_.build(particles, solids_);
}

} // namespace treacle::app
