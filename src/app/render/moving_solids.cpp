#include "app/render/moving_solids.hpp"

#include "app/setup/bodies.hpp"
#include "app/setup/geometry.hpp"
#include "base/text/csv_reader.hpp"
#include "base/text/error.hpp"
#include "rigid/algebra.hpp"
#include "surface/mesh/mirror.hpp"

#include <algorithm>

namespace treacle::app {

namespace {
// Rows of the table: the step, then the requested columns.
std::vector<std::vector<double>> read_columns(
    const std::filesystem::path& path, const std::vector<std::string>& names) {
    if (!std::filesystem::exists(path)) {
        throw InputError(
            {path.string(), "cannot be read", "it says where bodies are", "give the folder of a run that is whole"});
    }
    const auto table = read_csv(path);
    std::vector<const std::vector<double>*> columns{&table.column("step")};
    for (const auto& name : names) columns.push_back(&table.column(name));
    std::vector<std::vector<double>> rows(table.rows());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        for (const auto* column : columns) rows[i].push_back((*column)[i]);
    }
    return rows;
}
} // namespace

namespace {

void add_pose_columns(const std::string& body, std::vector<std::string>& names) {
    for (const auto& [what, unit] : {std::pair(" position", " [m]"), {" rotation", " [rad]"}, {" velocity", " [m/s]"},
             {" angular velocity", " [rad/s]"}}) {
        for (const char* axis : {" x", " y", " z"}) names.push_back(body + what + axis + unit);
    }
}

} // namespace

MovingSolids::MovingSolids(const Comm& comm, const RunView& run) {
    const auto& bodies = run.input.scene.bodies;
    if (bodies.empty()) return;
    const auto geometry = build_geometry(run.input);
    const bool any = treacle::app::any_moves(run.input);
    const auto setup = any ? make_bodies(run.input, geometry) : rigid::BodiesSetup{};
    std::vector<std::string> names;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        auto& solid = start_.emplace_back(surface::Solid{geometry.bodies[b]});
        moving_.push_back(-1);
        first_velocity_.push_back(bodies[b].velocity);
        if (!moves(bodies[b])) continue;
        solid.centre = setup.bodies[b].centre;
        moving_.back() = static_cast<int>(names.size());
        add_pose_columns(bodies[b].name, names);
    }
    if (!names.empty()) comm.guard([&] { poses_ = read_columns(run.folder.bodies(), names); });
}

const std::vector<double>* MovingSolids::row_of(std::int64_t step) const {
    const auto row = std::lower_bound(
        poses_.begin(), poses_.end(), static_cast<double>(step), [](const auto& one, double s) { return one[0] < s; });
    return row == poses_.end() || (*row)[0] != static_cast<double>(step) ? nullptr : &*row;
}

Vec3 MovingSolids::velocity(std::int64_t step, std::size_t body, const Vec3& x) const {
    const auto* row = row_of(step);
    if (moving_[body] < 0 || !row) return moving_[body] < 0 ? Vec3{0, 0, 0} : first_velocity_[body];
    const double* pose = row->data() + 1 + moving_[body];
    const Vec3 arm{x[0] - pose[0], x[1] - pose[1], x[2] - pose[2]};
    const double *u = pose + 6, *w = pose + 9;
    return {u[0] + w[1] * arm[2] - w[2] * arm[1], u[1] + w[2] * arm[0] - w[0] * arm[2],
        u[2] + w[0] * arm[1] - w[1] * arm[0]};
}

surface::Solids MovingSolids::at(std::int64_t step) const {
    surface::Solids out{start_};
    const auto* row = row_of(step);
    if (!row) return out;
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

std::function<double(const Vec3&)> distance_of_seen(
    const Input& input, const surface::Solids& solids, double none, const std::vector<std::string>& through) {
    std::vector<surface::Solid> seen;
    for (std::size_t b = 0; b < input.scene.bodies.size(); ++b) {
        const auto& body = input.scene.bodies[b];
        if (!body.shape.inverted && std::ranges::find(through, body.name) == through.end())
            seen.push_back(solids.bodies[b]);
    }
    return [seen = std::move(seen), none, domain = input.scene.domain](const Vec3& point) {
        double least = none;
        const auto x = surface::folded(point, domain);
        for (const auto& solid : seen) least = std::min(least, solid.distance(x));
        return least;
    };
}

} // namespace treacle::app
