#include "app/compare/compare_sheets.hpp"

#include "app/setup/bodies.hpp"
#include "app/video/run_flow.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "identify/compare/ball_track.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace treacle::app {

namespace {
using identify::BallMotion;
using identify::Experiment;
using identify::StudyFile;

// The body of a track: that of its name, or the only one that moves.
std::size_t ball_of(const Experiment& experiment, const scene::Scene& scene) {
    const auto& wanted = experiment.piv.ball.body;
    std::vector<std::string> names;
    std::vector<std::size_t> moving;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        names.push_back(scene.bodies[b].name);
        if (scene.bodies[b].name == wanted) return b;
        if (moves(scene.bodies[b])) moving.push_back(b);
    }
    if (wanted.empty() && moving.size() == 1) return moving.front();
    const auto close = nearest(wanted, names);
    throw InputError({experiment.piv.where,
        wanted.empty() ? "the ball has a track, and it is not said which body it is"
                       : "ball.body = " + wanted + " is no body of the scene",
        names.empty() ? "the scene has no bodies" : "it has " + join(names, ", "),
        close ? "did you mean " + *close + "?" : "give ball.body"});
}

// A body that was tracked: its region at the start, and its measured path in the scene's time.
struct Tracked {
    Tracked(const StudyFile& file, const Experiment& experiment, const scene::Scene& scene)
        : number(ball_of(experiment, scene)), region(scene.bodies[number].shape, scene.domain.dimensions),
          track(experiment.piv, file.beside(experiment.piv.ball.track)), time_zero(experiment.time_zero) {
        centre = region.moments().centre;
        size = region.surface_bounds().max[0] - region.surface_bounds().min[0];
    }
    Vec3 at(double time) const { return track.at(time + time_zero); }
    double distance(const Vec3& x, double time) const {
        const auto now = at(time);
        return region.distance({x[0] - now[0] + centre[0], x[1] - now[1] + centre[1], x[2] - now[2] + centre[2]});
    }

    std::size_t number;
    scene::SolidRegion region;
    identify::BallTrack track;
    double time_zero = 0; // [s]
    Vec3 centre{0, 0, 0}; // [m] at the start
    double size = 0;      // [m]
};

std::string vector_text(const Vec3& x) {
    return "[" + format_number(x[0]) + ", " + format_number(x[1]) + ", " + format_number(x[2]) + "]";
}

// Distance in the sheet between the tracked ball and a position.
double distance_in_sheet(const Experiment& experiment, const Tracked& ball, const Vec3& position) {
    double squared = 0;
    for (const auto& axis : {experiment.piv.right, experiment.piv.up}) {
        double along = 0;
        for (std::size_t k = 0; k < 3; ++k) along += axis[k] * (position[k] - ball.centre[k]);
        squared += along * along;
    }
    return std::sqrt(squared);
}

void check_path(const Experiment& experiment, const Tracked& ball, const std::string& name, double last) {
    const auto start = ball.at(0);
    if (distance_in_sheet(experiment, ball, start) > std::max(0.05 * ball.size, 3 * ball.track.deviation())) {
        throw InputError({experiment.piv.where,
            "ball.track is at " + vector_text(start) + " m at the scene's time 0, and the body " + name + " at " +
                vector_text(ball.centre) + " m",
            "they are one ball, and the run starts where its shape is",
            "move the body's shape, or look at time_zero, origin and axes"});
    }
    if (ball.track.first() > ball.time_zero || ball.track.last() < ball.time_zero + last) {
        throw InputError({experiment.piv.where,
            "ball.track goes from " + format_number(ball.track.first() - ball.time_zero) + " to " +
                format_number(ball.track.last() - ball.time_zero) + " s of the scene's time",
            "it is needed from 0 to " + format_number(last) + " s", "give `to`, or a longer track"});
    }
}

// The body follows the path: straight between keyframes, of which there are four from one field to the next.
study::Assignment path_assignment(
    const Experiment& experiment, const Tracked& ball, const std::string& name, double end, double interval) {
    constexpr double most = 1000;
    const auto count = int(std::clamp(std::ceil(4 * end / std::max(interval, 1e-9)), 50.0, most));
    const auto start = ball.at(0);
    std::string text;
    for (int i = 1; i <= count; ++i) {
        const double time = end * i / count;
        const auto now = ball.at(time);
        text += (i > 1 ? ", {time: " : "{time: ") + format_number(time) +
                ", translation: " + vector_text({now[0] - start[0], now[1] - start[1], now[2] - start[2]}) + "}";
    }
    return {"bodies." + name + ".keyframes=[" + text + "]", experiment.piv.where + ": ball.track"};
}

void check_domain(const Experiment& experiment, const identify::ObservedSheet& sheet, const scene::Domain& domain) {
    std::size_t outside = 0;
    Vec3 first{0, 0, 0};
    for (const auto& field : sheet.fields) {
        for (const auto& vector : field.vectors) {
            const auto point = experiment.piv.point(vector.x, vector.y);
            bool in = true;
            for (std::size_t k = 0; k < std::size_t(domain.dimensions); ++k)
                in = in && point[k] >= domain.min[k] && point[k] <= domain.max[k];
            if (in) continue;
            if (outside++ == 0) first = point;
        }
    }
    if (outside == 0) return;
    throw InputError({experiment.piv.where,
        std::to_string(outside) + " of " + std::to_string(sheet.counts.kept()) +
            " vectors are outside of the scene's domain, one at " + vector_text(first) + " m",
        "the domain goes from " + vector_text(domain.min) + " to " + vector_text(domain.max) + " m",
        "look at origin, right, up, y and pixel, or mask what is outside"});
}
} // namespace

identify::ObservedSheet observed_sheet(const StudyFile& file, const Experiment& experiment, const Input& input) {
    std::optional<Tracked> ball;
    if (experiment.piv.has_track()) ball.emplace(file, experiment, input.scene);
    const double radius = experiment.piv.window / std::sqrt(2.0); // to the window's corner
    const auto touches = [&](const Vec3& x, double time) { return ball->distance(x, time) < radius; };
    return identify::observe_sheet(
        experiment, [&](const std::string& name) { return file.beside(name); },
        ball ? identify::Touches(touches) : identify::Touches());
}

ObservationNeeds sheet_needs(const StudyFile& file, const Experiment& experiment, const Input& input) {
    const auto sheet = observed_sheet(file, experiment, input);
    check_end(experiment.where, experiment.name, sheet.fields.back().time, input.scene.time.end);
    check_domain(experiment, sheet, input.scene.domain);
    ObservationNeeds out;
    for (const auto& field : sheet.fields) out.times.push_back(field.time);
    const auto& s = experiment.piv;
    out.content = "sheet " + experiment.name + vector_text(s.origin) + vector_text(s.right) + vector_text(s.up) + " " +
                  format_number(s.window) + " " + format_number(s.noise);
    for (const auto& field : sheet.fields) {
        out.content += " " + format_number(field.time);
        for (const auto& one : field.vectors) {
            for (const double v : {one.x, one.y, one.u, one.v}) out.content += " " + format_number(v);
        }
    }
    // A method that changes with the viscosity has the effect of a flow that does.
    if (input.on_grid() && input.method.grid.stokes.solve == grid::StokesSolve::automatic) {
        out.assignments.push_back(
            {"method.grid.stokes.solve=together", s.where + ": one method over the range of viscosities"});
    }
    if (!s.has_track()) return out;
    const Tracked ball(file, experiment, input.scene);
    const auto& body = input.scene.bodies[ball.number];
    check_path(experiment, ball, body.name,
        s.ball.motion == BallMotion::prescribed ? input.scene.time.end : sheet.fields.back().time);
    if (s.ball.motion == BallMotion::free) return out;
    const auto origin = s.where + ": ball.track";
    for (const char* key :
        {"kind=kinematic", "density=0", "mass=0", "velocity=[0, 0, 0]", "angular_velocity=[0, 0, 0]", "locked=[]"})
        out.assignments.push_back({"bodies." + body.name + "." + key, origin});
    out.assignments.push_back(path_assignment(experiment, ball, body.name, input.scene.time.end,
        least_interval(sheet.fields, [](const auto& field) { return field.time; })));
    return out;
}

void compare_with_sheet(const Comm& comm, const StudyFile& file, const Experiment& experiment, const RunView& run,
    const std::filesystem::path& folder) {
    std::optional<identify::ObservedSheet> sheet;
    comm.guard([&] { sheet = observed_sheet(file, experiment, run.input); });
    RunFlow flow(comm, run);
    const auto count = sheet->fields.size(), ranks = std::size_t(comm.size()), rank = std::size_t(comm.rank());
    std::vector<double> numbers; // of this rank's fields, which follow one another
    comm.guard([&] {
        for (std::size_t f = count * rank / ranks; f < count * (rank + 1) / ranks; ++f) {
            const auto [before, after] = flow.around(sheet->fields[f].time);
            const auto& first = flow.frame(before);
            const auto one = identify::compare_field(experiment.piv, sheet->fields[f], first, flow.frame(after));
            numbers.insert(numbers.end(), {one.squares.square, one.squares.count});
            for (std::size_t i = 0; i < one.vectors.size(); ++i) {
                numbers.insert(numbers.end(), {one.vectors[i].u, one.vectors[i].v});
                for (std::size_t c = 0; c < 2; ++c) {
                    const auto& row = one.segments[2 * i + c];
                    numbers.insert(numbers.end(), {row.points, row.displacement});
                    numbers.insert(numbers.end(), row.by_view.begin(), row.by_view.begin() + identify::sheet_count);
                }
            }
        }
    });
    const auto all = comm.all_gather(std::span<const double>(numbers));
    comm.guard_root([&] {
        identify::RunResiduals residuals;
        residuals.kind = identify::ExperimentKind::piv;
        std::vector<identify::ComparedVector> vectors;
        const double* at = all.data();
        for (const auto& field : sheet->fields) {
            residuals.squares.push_back({field.number, field.time, at[0], at[1]});
            at += 2;
            for (const auto& vector : field.vectors) {
                vectors.push_back({field.number, vector, at[0], at[1]});
                at += 2;
                for (int c = 0; c < 2; ++c) {
                    identify::SegmentResidual row{field.number, field.time, vector.x, vector.y, c == 0 ? 1.0 : 0.0,
                        c == 0 ? 0.0 : 1.0, at[0], at[1], {}};
                    std::copy_n(at + 2, identify::sheet_count, row.by_view.begin());
                    residuals.segments.push_back(row);
                    at += 2 + identify::sheet_count;
                }
            }
        }
        identify::write_residuals(folder, experiment.name, residuals);
        identify::write_vectors(folder, experiment.name, vectors);
    });
}

} // namespace treacle::app
