#include "app/render/render.hpp"

#include "app/input/option_values.hpp"
#include "app/render/frame_field.hpp"
#include "app/render/frame_set.hpp"
#include "app/render/liquid_picture.hpp"
#include "app/render/moving_solids.hpp"
#include "app/setup/geometry.hpp"
#include "base/text/log.hpp"
#include "base/text/progress.hpp"
#include "base/text/text.hpp"
#include "video/clip/movie.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace treacle::app {

namespace {

// Number of values of all frames together: enough for percentiles that do not change visibly with more.
constexpr std::size_t values_for_range = 400000;

struct Job {
    RunView run;
    std::vector<std::size_t> frames;
    scene::Camera camera;
    video::View view;
    video::ValueRange range;
    std::vector<video::Rgb8> colours; // of the liquids, where no field colours them
    std::string stem;                 // of the files' names
};

SolidKind kind_of(const scene::Scene& scene, int number) {
    if (number < domain_sides) return SolidKind::wall;
    return scene.bodies[static_cast<std::size_t>(number - domain_sides)].shape.inverted ? SolidKind::hollow
                                                                                        : SolidKind::body;
}

DrawnSolids read_solids(const RunView& run, std::size_t frame_index) {
    DrawnSolids points;
    const auto path = run.solids_of(frame_index);
    if (!path) return points;
    auto frame = io::read_frame(*path);
    add_images(frame, run.input.scene.domain.mirrors());
    const auto body = scalar_field(frame, "body").values;
    for (std::size_t i = 0; i < body.size(); ++i) {
        const auto* x = frame.positions.data() + 3 * i;
        points.add({x[0], x[1], x[2]}, kind_of(run.input.scene, static_cast<int>(body[i])));
    }
    return points;
}

// One range for all pictures, the same on any number of ranks: from values picked evenly out of every frame.
video::ValueRange find_range(const Comm& comm, const RenderRequest& request, const Job& job) {
    if (request.field == no_field) return {};
    const auto values_per_frame = std::max<std::size_t>(200, values_for_range / job.frames.size());
    std::vector<double> picked;
    bool magnitude = false;
    comm.guard([&] {
        for (auto i = static_cast<std::size_t>(comm.rank()); i < job.frames.size();
             i += static_cast<std::size_t>(comm.size())) {
            const auto field = scalar_field(io::read_frame(job.run.frame(job.frames[i])), request.field);
            const auto stride = std::max<std::size_t>(1, field.values.size() / values_per_frame);
            for (std::size_t k = 0; k < field.values.size(); k += stride) picked.push_back(field.values[k]);
            magnitude = magnitude || field.magnitude;
        }
    });
    const auto all = comm.all_gather(std::span<const double>(picked));
    auto range = video::robust_range(all, request.map);
    if (comm.any(magnitude) && request.map == video::ColourMap::viridis) range.low = 0;
    return range;
}

std::optional<video::Rgb8> read_colour(const std::string& text) {
    unsigned number = 0;
    if (text.size() != 7 || text[0] != '#') return {};
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + 7, number, 16);
    if (end != text.data() + 7 || error != std::errc{}) return {};
    return video::Rgb8{std::uint8_t(number >> 16), std::uint8_t(number >> 8), std::uint8_t(number)};
}

// Colours of all liquids, those that are not given as they are without.
std::vector<video::Rgb8> own_colours(const RenderRequest& request, const scene::Scene& scene) {
    std::vector<video::Rgb8> out;
    std::vector<std::string> names;
    for (const auto& liquid : scene.liquids) {
        out.push_back(video::colour_of_liquid(int(out.size())));
        names.push_back(liquid.name);
    }
    for (const auto& assignment : request.colours) {
        const std::string where = "--colour " + assignment;
        if (request.field != no_field)
            throw InputError(
                {where, "has no effect", "the field colours the liquid", "add --field none, or leave it out"});
        const auto equals = assignment.find('=');
        const auto colour = equals == std::string::npos ? std::nullopt : read_colour(assignment.substr(equals + 1));
        if (!colour)
            throw InputError({where, "is no colour of a liquid",
                "it takes a name, and red, green and blue as hexadecimal digits", "write for instance honey=#d68018"});
        const auto found = std::ranges::find(names, assignment.substr(0, equals));
        if (found == names.end())
            throw InputError({where, "the run has no such liquid", "it has " + join(names, ", "), ""});
        out[std::size_t(found - names.begin())] = *colour;
    }
    return out;
}

// Draws the pictures of one rank.
class Painter {
public:
    // Collective.
    Painter(const Comm& comm, const RenderRequest& request, const Job& job) : request_(request), job_(job) {
        if (request.cut) {
            if (job.run.input.scene.domain.dimensions != 3)
                throw InputError(
                    {"--cut", "the scene is in two dimensions", "it shows all that is in it", "leave it out"});
            (void)video::facing(*request.cut, video::Camera(job.view)); // throws for fields that cannot be drawn
            if (request.style == Style::spheres) solids_.emplace(comm, job.run);
        }
        if (request.style == Style::surface) {
            const auto& domain = job.run.input.scene.domain;
            liquid_.emplace(comm, job.run,
                video::LiquidScene{job.view, domain_box(domain), domain.spacing, job.range, request.cut},
                request.field);
        }
    }

    // Collective: the picture of frames[first + rank] of each rank; none where there is no such frame.
    video::Image draw(const Comm& comm, std::size_t first) {
        const auto ranks = static_cast<std::size_t>(comm.size()), mine = first + static_cast<std::size_t>(comm.rank());
        std::optional<LiquidPicture> liquid;
        for (std::size_t rank = 0; liquid_ && rank < ranks && first + rank < job_.frames.size(); ++rank) {
            auto picture = liquid_->draw(job_.frames[first + rank], static_cast<int>(rank));
            if (picture) liquid = std::move(picture);
        }
        video::Image image;
        comm.guard([&] {
            if (mine < job_.frames.size())
                image = liquid_ ? draw_surface(job_.frames[mine], *liquid) : draw_spheres(job_.frames[mine]);
        });
        return image;
    }

private:
    video::RenderRequest scenery() const {
        video::RenderRequest picture;
        picture.domain = domain_box(job_.run.input.scene.domain);
        picture.view = job_.view;
        picture.background = request_.background;
        picture.cut = request_.cut;
        return picture;
    }

    std::function<double(const Vec3&)> distance(const surface::Solids& solids) const {
        if (!request_.cut) return {};
        const auto& domain = job_.run.input.scene.domain;
        return distance_of_seen(job_.run.input, solids,
            std::hypot(domain.max[0] - domain.min[0], domain.max[1] - domain.min[1], domain.max[2] - domain.min[2]));
    }

    video::Image draw_spheres(std::size_t frame_index) const {
        auto frame = io::read_frame(job_.run.frame(frame_index));
        const auto& scene = job_.run.input.scene;
        add_images(frame, scene.domain.mirrors());
        const auto field = scalar_field(frame, request_.field);
        auto picture = scenery();
        picture.caption = video::caption_of(scene.title, frame.time, static_cast<std::size_t>(frame.total));
        auto& liquid = picture.layers.emplace_back();
        liquid.positions = frame.positions;
        liquid.radius = scene.domain.spacing / 2;
        liquid.values = field.values;
        liquid.title = field.title;
        liquid.map = request_.map;
        liquid.range = job_.range;
        const auto solids = read_solids(job_.run, frame_index);
        add_solid_layers(solids, scene.domain.spacing, picture.layers);
        if (solids_) picture.solid_distance = distance(solids_->at(frame.step));
        return video::render_frame(picture);
    }

    video::Image draw_surface(std::size_t frame_index, const LiquidPicture& liquid) const {
        const auto& scene = job_.run.input.scene;
        auto picture = scenery();
        picture.caption = video::caption_of(scene.title, liquid.time, static_cast<std::size_t>(liquid.total));
        picture.liquid = video::LiquidLayer{&liquid.view, request_.field != no_field, liquid.title, request_.map,
            job_.range, liquid.has_lower, liquid.has_higher, scene.domain.spacing, job_.colours};
        const auto solids = read_solids(job_.run, frame_index);
        add_solid_layers(solids, scene.domain.spacing, picture.layers);
        picture.solid_distance = distance(liquid.solids);
        return video::render_frame(picture);
    }

    const RenderRequest& request_;
    const Job& job_;
    std::optional<MovingSolids> solids_;
    std::optional<LiquidPainter> liquid_;
};

Job plan(const Comm& comm, const RenderRequest& request) {
    Job job;
    job.run = open_run(comm, request.folder);
    require_frames(job.run);
    const auto& scene = job.run.input.scene;
    job.frames = pick_frames(read_frame_range(request.frames), job.run.frames.size());
    job.camera = find_camera(scene, request.camera);
    job.view = view_of(job.camera, scene.domain, request.size);
    job.stem = job.camera.name + "_" + (request.field == no_field ? "liquid" : request.field);
    job.colours = own_colours(request, scene);
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

std::filesystem::path picture_path(const std::filesystem::path& out, const Job& job, std::size_t frame_index) {
    const auto frame = job.run.frame(frame_index).stem().string(); // NAME_000042
    return out / (job.stem + frame.substr(frame.rfind('_')) + ".png");
}

class MovieMaker {
public:
    MovieMaker(const Comm& comm, const RenderRequest& request, const Job& job, const std::filesystem::path& path)
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

video::CutPlane read_cut(const std::string& text) {
    const std::string option = "--cut";
    if (const auto sides = split_at(text, '='); sides.size() == 2) {
        const auto axis = std::string("xyz").find(sides[0]);
        const auto position = read_quantity(sides[1], unit::length);
        if (sides[0].size() == 1 && axis != std::string::npos && std::holds_alternative<double>(position)) {
            video::CutPlane cut{{0, 0, 0}, {0, 0, 0}};
            cut.point[axis] = std::get<double>(position);
            cut.normal[axis] = 1;
            return cut;
        }
    } else if (const auto parts = split_at(text, ';'); parts.size() == 2) {
        return {read_vector(parts[0], unit::length, option), read_vector(parts[1], unit::none, option)};
    }
    throw InputError(
        {option + " \"" + text + "\"", "is no plane", "it takes an axis and a place on it, or a point and a normal",
            "write for instance \"x=5 cm\", or \"10 0 5 cm; 1 0 1\""});
}

ExitCode render_run(const Comm& comm, const RenderRequest& request) {
    const Job job = plan(comm, request);
    Painter painter(comm, request, job);
    const auto out = request.out.empty() ? job.run.folder.root / "pictures" : request.out;
    comm.guard_root([&] { make_output_folder(out); });
    Log log(comm.is_root() ? LogOutput::enabled : LogOutput::disabled);

    std::optional<MovieMaker> movie;
    const bool wanted = request.movie == Movie::write && (job.frames.size() > 1 || !request.movie_file.empty());
    if (wanted) {
        const auto path = request.movie_file.empty() ? out / (job.stem + ".mp4") : request.movie_file;
        movie.emplace(comm, request, job, path);
    }
    Progress progress(log, "render", "pictures");
    const auto ranks = static_cast<std::size_t>(comm.size());
    for (std::size_t first = 0; first < job.frames.size(); first += ranks) {
        const auto i = first + static_cast<std::size_t>(comm.rank());
        const auto image = painter.draw(comm, first);
        comm.guard([&] {
            if (i < job.frames.size()) video::write_png(picture_path(out, job, job.frames[i]), image);
        });
        if (movie) movie->add(image);
        const auto done = std::min(first + ranks, job.frames.size());
        progress.report(static_cast<std::int64_t>(done), std::ssize(job.frames));
    }
    progress.finish();
    log.line(std::to_string(job.frames.size()) + (job.frames.size() == 1 ? " picture: " : " pictures: ") +
             picture_path(out, job, job.frames.front()).string() +
             (job.frames.size() > 1 ? " ... " + picture_path(out, job, job.frames.back()).filename().string() : ""));
    if (movie) movie->finish(log);
    return ExitCode::ok;
}

} // namespace treacle::app
