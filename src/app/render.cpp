#include "app/render.hpp"

#include "app/frame_field.hpp"
#include "app/frame_set.hpp"
#include "app/geometry.hpp"
#include "base/log.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "video/movie.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {

// Of all frames together: enough for percentiles that do not change visibly with more.
constexpr std::size_t values_for_range = 400000;

struct Job {
    RunView run;
    std::vector<std::size_t> frames;
    scene::Camera camera;
    video::View view;
    video::ValueRange range;
    std::string stem; // of the files' names
};

SolidKind kind_of(const scene::Scene& scene, int number) {
    if (number < domain_sides) return SolidKind::wall;
    return scene.bodies[static_cast<std::size_t>(number - domain_sides)].shape.inverted ? SolidKind::hollow : SolidKind::body;
}

DrawnSolids read_solids(const RunView& run, std::size_t frame_index) {
    DrawnSolids points;
    const auto path = run.solids_of(frame_index);
    if (!path) return points;
    const auto frame = io::read_frame(*path);
    const auto body = scalar_field(frame, "body").values;
    for (std::size_t i = 0; i < body.size(); ++i) {
        const auto* x = frame.positions.data() + 3 * i;
        points.add({x[0], x[1], x[2]}, kind_of(run.input.scene, static_cast<int>(body[i])));
    }
    return points;
}

// One range for all pictures, the same on any number of ranks: from values picked evenly out of every frame.
video::ValueRange find_range(const Comm& comm, const RenderRequest& request, const Job& job) {
    const auto share = std::max<std::size_t>(200, values_for_range / job.frames.size());
    std::vector<double> picked;
    bool magnitude = false;
    comm.guard([&] {
        for (auto i = static_cast<std::size_t>(comm.rank()); i < job.frames.size();
             i += static_cast<std::size_t>(comm.size())) {
            const auto field = scalar_field(io::read_frame(job.run.frame(job.frames[i])), request.field);
            const auto stride = std::max<std::size_t>(1, field.values.size() / share);
            for (std::size_t k = 0; k < field.values.size(); k += stride) picked.push_back(field.values[k]);
            magnitude = magnitude || field.magnitude;
        }
    });
    const auto all = comm.all_gather(std::span<const double>(picked));
    auto range = video::robust_range(all, request.map);
    if (comm.any(magnitude) && request.map == video::ColourMap::viridis) range.low = 0;
    return range;
}

video::Image draw(const RenderRequest& request, const Job& job, std::size_t frame_index) {
    const auto frame = io::read_frame(job.run.frame(frame_index));
    const auto field = scalar_field(frame, request.field);
    const auto& scene = job.run.input.scene;
    video::RenderRequest picture;
    picture.domain = domain_box(scene.domain);
    picture.view = job.view;
    picture.look = request.look;
    picture.background = request.background;
    picture.caption = video::caption_of(scene.title, frame.time, static_cast<std::size_t>(frame.size()));
    auto& liquid = picture.layers.emplace_back();
    liquid.positions = frame.positions;
    liquid.radius = scene.domain.spacing / 2;
    liquid.values = field.values;
    liquid.title = field.title;
    liquid.map = request.map;
    liquid.range = job.range;
    const auto solids = read_solids(job.run, frame_index);
    add_solid_layers(solids, scene.domain.spacing, picture.layers);
    return video::render_frame(picture);
}

Job plan(const Comm& comm, const RenderRequest& request) {
    Job job;
    job.run = open_run(comm, request.folder);
    require_frames(job.run);
    const auto& scene = job.run.input.scene;
    job.frames = pick_frames(read_frame_range(request.frames), job.run.frames.size());
    job.camera = find_camera(scene, request.camera);
    job.view = view_of(job.camera, scene.domain, request.size);
    job.stem = job.camera.name + "_" + request.field;
    job.range = request.range ? *request.range : find_range(comm, request, job);
    return job;
}

// Frames may lie unevenly in time; the movie shows them at their mean distance.
double frames_per_second(const RenderRequest& request, const Job& job) {
    if (request.frames_per_second > 0) return request.frames_per_second;
    const auto& frames = job.run.frames;
    const double span = frames[job.frames.back()].time - frames[job.frames.front()].time;
    if (span <= 0) return 30;
    return std::clamp(std::round(static_cast<double>(job.frames.size() - 1) / span), 10.0, 60.0);
}

std::filesystem::path picture_path(const std::filesystem::path& out, const Job& job,
                                   std::size_t frame_index) {
    const auto frame = job.run.frame(frame_index).stem().string(); // NAME_000042
    return out / (job.stem + frame.substr(frame.rfind('_')) + ".png");
}

class MovieMaker {
public:
    MovieMaker(const Comm& comm, const RenderRequest& request, const Job& job,
               const std::filesystem::path& path)
        : comm_(comm) {
        comm.guard_root([&] {
            video::MovieOptions options;
            options.frames_per_second = frames_per_second(request, job);
            options.width = job.view.width;
            options.height = job.view.height;
            writer_.emplace(path, options);
        });
    }

    // Collective: the pictures of all ranks, in the order of the ranks; one without pixels is left out.
    void add(const video::Image& mine) {
        for (int rank = 0; rank < comm_.size(); ++rank) {
            std::string pixels(mine.pixels.begin(), mine.pixels.end());
            pixels = comm_.broadcast(pixels, rank);
            comm_.guard_root([&] {
                if (pixels.empty()) return;
                // Rank 0 draws in every round, so its own picture has the size of all.
                writer_->add({mine.width, mine.height, {pixels.begin(), pixels.end()}});
            });
        }
    }

    // Collective. Path and, if there is one, a message, on rank 0.
    void finish(Log& log) {
        std::filesystem::path path;
        comm_.guard_root([&] { path = writer_->finish(); });
        if (!comm_.is_root()) return;
        if (!writer_->message().empty()) log.warn(writer_->message());
        log.line("movie: " + path.string());
    }

private:
    Comm comm_;
    std::optional<video::MovieWriter> writer_; // on rank 0
};

} // namespace

video::ValueRange read_value_range(const std::string& text) {
    const auto colon = text.find(':');
    if (colon != std::string::npos) {
        const auto low = read_number(std::string_view(text).substr(0, colon));
        const auto high = read_number(std::string_view(text).substr(colon + 1));
        if (low && high && std::isfinite(*low) && std::isfinite(*high) && *low < *high) return {*low, *high};
    }
    throw InputError({"--range " + text, "is no range of values", "it takes two numbers, the lower one first",
                      "write for instance 0:2.5"});
}

ExitCode render_run(const Comm& comm, const RenderRequest& request) {
    const Job job = plan(comm, request);
    const auto out = request.out.empty() ? job.run.folder.root / "pictures" : request.out;
    comm.guard_root([&] { make_output_folder(out); });
    Log log(comm.is_root() ? Voice::speaks : Voice::silent);

    std::optional<MovieMaker> movie;
    const bool wanted =
        request.movie == Movie::write && (job.frames.size() > 1 || !request.movie_file.empty());
    if (wanted) {
        const auto path = request.movie_file.empty() ? out / (job.stem + ".mp4") : request.movie_file;
        movie.emplace(comm, request, job, path);
    }
    Progress progress(log, "render", "pictures");
    const auto ranks = static_cast<std::size_t>(comm.size());
    for (std::size_t first = 0; first < job.frames.size(); first += ranks) {
        const auto i = first + static_cast<std::size_t>(comm.rank());
        video::Image image;
        comm.guard([&] {
            if (i >= job.frames.size()) return;
            image = draw(request, job, job.frames[i]);
            video::write_png(picture_path(out, job, job.frames[i]), image);
        });
        if (movie) movie->add(image);
        const auto done = std::min(first + ranks, job.frames.size());
        progress.report(static_cast<std::int64_t>(done), std::ssize(job.frames));
    }
    progress.finish();
    log.line(std::to_string(job.frames.size()) + (job.frames.size() == 1 ? " picture: " : " pictures: ") +
             picture_path(out, job, job.frames.front()).string() +
             (job.frames.size() > 1 ? " ... " + picture_path(out, job, job.frames.back()).filename().string()
                                    : ""));
    if (movie) movie->finish(log);
    return ExitCode::ok;
}

} // namespace treacle::app
