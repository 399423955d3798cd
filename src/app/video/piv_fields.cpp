#include "app/video/piv_fields.hpp"

#include "app/video/run_flow.hpp"
#include "base/text/csv.hpp"
#include "base/text/csv_reader.hpp"
#include "base/text/log.hpp"
#include "base/text/text.hpp"
#include "scene/sampling/signed_distance.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

namespace treacle::app {

namespace {
struct Vectors {
    double time = 0;
    std::vector<double> u, v;
    std::vector<char> valid;
};

// Grid of the vectors' places, by rows from the sheet's origin.
struct Grid {
    std::size_t columns = 0, rows = 0;
    double step = 0; // [m]

    explicit Grid(const PivRequest& r)
        : columns(std::size_t(r.width / r.step * (1 + 1e-9)) + 1),
          rows(std::size_t(r.height / r.step * (1 + 1e-9)) + 1), step(r.step) {}
    double x(std::size_t i) const { return double(i % columns) * step; }
    double y(std::size_t i) const {
        const std::size_t row = i / columns;
        return double(row) * step;
    }
    std::size_t size() const { return columns * rows; }
};

Vectors sample(const PivRequest& request, const Grid& grid, RunFlow& flow, double time) {
    const auto [before, after] = flow.around(time);
    const auto& a = flow.frame(before);
    const auto& b = flow.frame(after);
    const double fraction = b.time > a.time ? (time - a.time) / (b.time - a.time) : 0;
    Vectors out{time, {}, {}, {}};
    for (std::size_t i = 0; i < grid.size(); ++i) {
        const auto p = identify::window_velocity(request.sheet, grid.x(i), grid.y(i), a),
                   q = identify::window_velocity(request.sheet, grid.x(i), grid.y(i), b);
        out.valid.push_back(p.seen && q.seen && !p.touches && !q.touches);
        out.u.push_back((1 - fraction) * p.velocity[0] + fraction * q.velocity[0]);
        out.v.push_back((1 - fraction) * p.velocity[1] + fraction * q.velocity[1]);
    }
    return out;
}

// Noise of deviation 1 in which vectors share what their windows share.
std::vector<double> window_noise(const Grid& grid, double window, std::mt19937_64& draw) {
    const auto wide = std::size_t(std::max(1.0, std::round(window / grid.step)));
    const auto across = grid.columns + wide - 1;
    std::normal_distribution<double> normal;
    std::vector<double> cells(across * (grid.rows + wide - 1)), out;
    for (auto& cell : cells) cell = normal(draw);
    for (std::size_t i = 0; i < grid.size(); ++i) {
        double sum = 0;
        for (std::size_t row = 0; row < wide; ++row) {
            for (std::size_t column = 0; column < wide; ++column)
                sum += cells[(i / grid.columns + row) * across + i % grid.columns + column];
        }
        out.push_back(sum / double(wide));
    }
    return out;
}

void disturb(const PivRequest& request, const Grid& grid, double speed, std::mt19937_64& draw, Vectors& field) {
    const auto noise_u = window_noise(grid, request.sheet.window, draw),
               noise_v = window_noise(grid, request.sheet.window, draw);
    std::uniform_real_distribution<double> any(-1, 1), chance(0, 1);
    for (std::size_t i = 0; i < grid.size(); ++i) {
        field.u[i] += request.noise * speed * noise_u[i];
        field.v[i] += request.noise * speed * noise_v[i];
        if (chance(draw) >= request.outliers) continue;
        field.u[i] = speed * any(draw);
        field.v[i] = speed * any(draw);
    }
}

void write_field(const std::filesystem::path& path, const Grid& grid, const Vectors& field) {
    auto table = CsvTable::create(path, {"x [mm]", "y [mm]", "u [m/s]", "v [m/s]", "valid"});
    for (std::size_t i = 0; i < grid.size(); ++i) {
        table.append(
            std::vector<double>{1e3 * grid.x(i), 1e3 * grid.y(i), field.u[i], field.v[i], double(field.valid[i])});
    }
    table.sync();
}

void write_track(const PivRequest& request, const RunView& run, std::mt19937_64& draw) {
    const auto bodies = read_csv(run.folder.bodies());
    const auto& times = bodies.column("time");
    auto table = CsvTable::create(request.out / "track.csv", {"time [s]", "x [mm]", "y [mm]", "plus_minus [mm]"});
    std::normal_distribution<double> normal;
    const std::vector<double>* position[3] = {&bodies.column(request.track + " position x"),
        &bodies.column(request.track + " position y"), &bodies.column(request.track + " position z")};
    const auto add = [&](double time, const Vec3& at) {
        double x = 0, y = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            x += request.sheet.right[k] * (at[k] - request.sheet.origin[k]);
            y += request.sheet.up[k] * (at[k] - request.sheet.origin[k]);
        }
        table.append(std::vector<double>{time, 1e3 * (x + request.track_noise * normal(draw)),
            1e3 * (y + request.track_noise * normal(draw)), 1e3 * request.track_noise});
    };
    const auto& scene = run.input.scene;
    const auto body =
        std::ranges::find(scene.bodies, request.track, &scene::Body::name); // the table has its columns, so it is there
    add(0, scene::SolidRegion(body->shape, scene.domain.dimensions).moments().centre);
    for (std::size_t i = 0; i < times.size(); ++i)
        add(times[i], {(*position[0])[i], (*position[1])[i], (*position[2])[i]});
    table.sync();
}

void make(const PivRequest& request, const RunView& run, RunFlow& flow) {
    const Grid grid(request);
    std::vector<Vectors> fields;
    const double last = request.last > 0 ? request.last : run.frames.back().time;
    for (std::size_t k = 0; request.first + double(k) * request.interval <= last * (1 + 1e-9); ++k) {
        fields.push_back(sample(request, grid, flow, request.first + double(k) * request.interval));
    }
    double speed = 0;
    std::size_t valid = 0;
    for (const auto& field : fields) {
        for (std::size_t i = 0; i < grid.size(); ++i) {
            if (field.valid[i]) speed = std::max(speed, std::hypot(field.u[i], field.v[i]));
            valid += field.valid[i] != 0;
        }
    }
    std::mt19937_64 draw{std::uint64_t(request.seed)};
    std::filesystem::create_directories(request.out);
    auto times = CsvTable::create(request.out / "times.csv", {"time [s]"});
    for (std::size_t k = 0; k < fields.size(); ++k) {
        disturb(request, grid, speed, draw, fields[k]);
        char name[32];
        std::snprintf(name, sizeof name, "field_%04zu.csv", k);
        write_field(request.out / name, grid, fields[k]);
        times.append(std::vector<double>{fields[k].time});
    }
    times.sync();
    if (!request.track.empty()) write_track(request, run, draw);
    Log(LogOutput::enabled)
        .line(std::to_string(fields.size()) + " fields of " + std::to_string(grid.size()) + " vectors, " +
              std::to_string(valid) + " measured, largest speed " + format_number(speed) + " m/s, noise " +
              format_number(request.noise * speed) + " m/s, in " + request.out.string());
}
} // namespace

ExitCode make_piv_fields(const Comm& comm, const PivRequest& request) {
    const auto run = open_run(comm, request.run);
    require_frames(run);
    RunFlow flow(comm, run);
    comm.guard_root([&] {
        if (request.last > run.frames.back().time * (1 + 1e-9)) {
            throw InputError({"--to " + format_number(request.last), "is after the run's last frame",
                "that is at " + format_number(run.frames.back().time) + " s", "give an earlier time"});
        }
        make(request, run, flow);
    });
    return ExitCode::ok;
}

} // namespace treacle::app
