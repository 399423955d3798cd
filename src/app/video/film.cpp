#include "app/video/film.hpp"

#include "app/input/keep_memory.hpp"
#include "app/render/frame_set.hpp"
#include "app/render/picture.hpp"
#include "app/render/scene_surface.hpp"
#include "app/render/scenery.hpp"
#include "base/text/csv.hpp"
#include "base/text/file.hpp"
#include "base/text/log.hpp"
#include "base/text/progress.hpp"
#include "base/text/text.hpp"
#include "video/clip/time_map.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace treacle::app {

namespace {

// A frame of the film: its stamp in the file, the run's time at the middle of its exposure, the run's frame nearest to it.
struct FilmFrame {
    double stamp = 0, time = 0;       // [s]
    std::optional<std::size_t> frame; // none: the empty scene
};

std::uint64_t hash(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
}

// In [-1, 1).
double random_at(std::uint64_t seed, std::uint64_t k) {
    return static_cast<double>(hash(seed * 0x9e3779b97f4a7c15 + k) >> 11) * 0x1p-52 - 1;
}

[[noreturn]] void refuse(const std::string& option, const std::string& problem, const std::string& cure) {
    throw InputError({"treacle film " + option, problem, "", cure});
}

void check(const FilmRequest& request) {
    if (!(request.rate > 0) || request.rate > 100000) refuse("--rate", "must be > 0", "30 frames per second is usual");
    if (request.jitter < 0 || request.jitter > 0.9)
        refuse("--jitter", "must be in [0, 0.9]", "0.2 is a phone in the dark");
    if (request.shot.exposure < 0 || request.shot.exposure > 1 / request.rate)
        refuse("--exposure", "must be between 0 and the interval of the frames", "half of it is usual");
    if (request.look.blur < 0 || request.look.noise < 0)
        refuse("--blur, --noise", "must be >= 0", "0.8 and 1.5 are usual");
    if (std::abs(request.look.exposure_drift) >= 1) refuse("--drift", "must be below 1", "0.2 is much");
}

// Stamps begin at 0; the run's first filmed time is at the stamp lead + still.
std::vector<FilmFrame> plan_frames(const FilmRequest& request, const RunView& run) {
    const double first = request.first >= 0 ? request.first : run.frames.front().time;
    const double last = request.last >= 0 ? request.last : run.frames.back().time;
    if (!(last > first))
        refuse("--to", "must be after --from",
            "the run goes from " + format_number(run.frames.front().time) + " to " +
                format_number(run.frames.back().time) + " s");
    const auto map = request.time_map.empty() ? video::TimeMap{} : video::TimeMap::read(request.time_map);
    const double start = request.lead + request.still;
    std::vector<FilmFrame> frames;
    double largest_gap = 0;
    for (std::size_t i = 1; i < run.frames.size(); ++i)
        largest_gap = std::max(largest_gap, run.frames[i].time - run.frames[i - 1].time);
    for (std::uint64_t k = 0; k < 1000000; ++k) {
        FilmFrame frame;
        const double wobble = k == 0 ? 0 : 0.5 * request.jitter * random_at(request.look.seed, k);
        frame.stamp = (static_cast<double>(k) + request.phase + wobble) / request.rate;
        const double clock = map.at(frame.stamp) - start; // of the run, from `first`
        if (clock > last - first + 1e-9) break;
        frame.time = first + std::max(0.0, clock);
        if (clock >= -request.still - 1e-9) frame.frame = nearest_frame(run, frame.time);
        frames.push_back(frame);
    }
    if (frames.size() < 2) refuse("--rate", "gives fewer than two frames", "raise it, or film a longer run");
    return frames;
}

// Draws the frames of one rank.
class Camera {
public:
    Camera(const FilmRequest& request, const RunView& run, const scene::CameraModel& model)
        : request_(request), run_(run), model_(model),
          surface_(Comm::self(), run, {.options = surface_options(run.input), .images = true}) {}

    struct Shot {
        video::Image image;
        video::Mask mask;
    };
    Shot shoot(const FilmFrame& frame, std::size_t number, std::size_t of) {
        const auto index = frame.frame.value_or(0);
        const auto& mesh = surface_.build(index);
        draw_scenery();
        const double phase = static_cast<double>(number) / static_cast<double>(of);
        if (!frame.frame) {
            const auto& lens = model_.lens();
            const auto pixels = std::size_t(lens.width) * std::size_t(lens.height);
            return {painter_->paint_empty(phase, number),
                {lens.width, lens.height, std::vector<std::uint8_t>(pixels, video::mask_background)}};
        }
        auto shot = request_.shot;
        shot.offset = frame.time - surface_.time();
        const bool rests = request_.still > 0 && frame.time <= run_.frames.front().time;
        const video::FilmMesh drawn{mesh.dimensions, mesh.vertices, mesh.normals,
            rests ? std::span<const double>{} : std::span<const double>(mesh.velocity), mesh.triangles};
        auto drawing = video::draw_liquid(drawn, model_, shot, scenery_.depth);
        return {painter_->paint(drawing.light, phase, number), std::move(drawing.mask)};
    }

private:
    // Once for bodies that stay, for each frame for those that move.
    void draw_scenery() {
        const bool moves = surface_.solids_move();
        if (painter_ && !moves) return;
        scenery_ = app::draw_scenery(run_.input, surface_.solids(), model_, request_.see_through);
        auto look = request_.look;
        look.width = model_.lens().width;
        look.height = model_.lens().height;
        painter_.emplace(look, scenery_.light);
    }

    const FilmRequest& request_;
    const RunView& run_;
    const scene::CameraModel& model_;
    SceneSurface surface_;
    video::FilmScenery scenery_;
    std::optional<video::FilmPainter> painter_;
};

// Files that rank 0 writes.
class FilmFolder {
public:
    FilmFolder(const FilmRequest& request, const std::filesystem::path& out, const scene::CameraModel& model)
        : folder_(out, request.existing), table_(CsvTable::create(folder_.path() / "film.csv",
                                              {"frame", "stamp [s]", "time [s]", "run frame", "area [px]"})) {
        video::ClipOptions options;
        options.width = model.lens().width;
        options.height = model.lens().height;
        options.codec = request.codec;
        options.quality = request.quality;
        options.turned = request.turned;
        options.frames_per_second = request.rate;
        name_ = request.codec == video::ClipCodec::ffv1 ? "film.mkv" : "film.mp4";
        writer_.emplace(folder_.path() / name_, options);
    }

    void add(std::size_t number, const FilmFrame& frame, const video::Image& image, const video::Mask& mask) {
        writer_->add(image, frame.stamp);
        video::write_mask(folder_.path() / video::mask_name(std::int64_t(number)), mask);
        table_.append(std::vector<double>{
            double(number), frame.stamp, frame.time, frame.frame ? double(*frame.frame) : -1, double(mask.area())});
    }

    void finish(const nlohmann::ordered_json& summary) {
        writer_->finish();
        table_.sync();
        write_file_atomically(folder_.path() / "film.json", summary.dump(2) + "\n");
        folder_.finish();
    }
    const std::string& name() const { return name_; }

private:
    FolderUnderWay folder_;
    CsvTable table_;
    std::string name_;
    std::optional<video::ClipWriter> writer_;
};

nlohmann::ordered_json summary_of_camera(const scene::CameraModel& model) {
    const auto& lens = model.lens();
    return {{"name", model.name()}, {"width", lens.width}, {"height", lens.height}, {"fx", lens.fx}, {"fy", lens.fy},
        {"cx", lens.cx}, {"cy", lens.cy}, {"distortion", lens.distortion},
        {"rotation_vector", scene::rotation_vector(model.pose().rotation)},
        {"translation_vector", model.pose().translation}};
}

nlohmann::ordered_json summary_of(
    const FilmRequest& request, const scene::CameraModel& model, const std::vector<FilmFrame>& frames) {
    const auto& look = request.look;

    nlohmann::ordered_json out;
    out["run"] = request.run.string();
    out["frames"] = frames.size();
    out["rate_hz"] = request.rate;
    out["jitter"] = request.jitter;
    out["start_stamp_s"] = request.lead + request.still;
    out["turned_degrees"] = request.turned;
    out["camera"] = summary_of_camera(model);
    out["look"] = {{"texture", look.texture}, {"uneven_light", look.uneven_light},
        {"exposure_drift", look.exposure_drift}, {"blur_px", look.blur}, {"noise", look.noise}, {"shadow", look.shadow},
        {"background", look.background}, {"seed", look.seed}};
    out["shot"] = {{"exposure_s", request.shot.exposure}, {"readout_s", request.shot.readout},
        {"colour", request.shot.colour}, {"samples", request.shot.samples}, {"instants", request.shot.instants}};
    return out;
}

// The picture and mask of another rank, on rank 0.
std::string bytes_of(const std::vector<std::uint8_t>& values) { return {values.begin(), values.end()}; }
} // namespace

ExitCode film_run(const Comm& comm, const FilmRequest& request) {
    keep_memory();
    check(request);
    const auto run = open_run(comm, request.run);
    require_frames(run);
    require_bodies(run.input, request.see_through, "--see-through");
    const auto frames = plan_frames(request, run);
    const auto camera_of_scene = find_camera(run.input.scene, request.camera);
    const auto model = video::camera_model(view_of(camera_of_scene, run.input.scene.domain, {}), camera_of_scene.name);
    const auto out = request.out.empty() ? run.folder.root / "film" : request.out;
    std::optional<FilmFolder> folder;
    comm.guard_root([&] { folder.emplace(request, out, model); });
    std::optional<Camera> camera;
    comm.guard([&] { camera.emplace(request, run, model); });
    Log log(comm.is_root() ? LogOutput::enabled : LogOutput::disabled);
    Progress progress(log, "film", "frames");
    const auto ranks = static_cast<std::size_t>(comm.size());
    for (std::size_t begin = 0; begin < frames.size(); begin += ranks) {
        const auto mine = begin + static_cast<std::size_t>(comm.rank());
        Camera::Shot shot;
        comm.guard([&] {
            if (mine < frames.size()) shot = camera->shoot(frames[mine], mine, frames.size());
        });
        for (std::size_t rank = 0; rank < ranks && begin + rank < frames.size(); ++rank) {
            const auto image =
                ranks > 1 ? comm.broadcast(bytes_of(shot.image.pixels), int(rank)) : bytes_of(shot.image.pixels);
            const auto mask =
                ranks > 1 ? comm.broadcast(bytes_of(shot.mask.pixels), int(rank)) : bytes_of(shot.mask.pixels);
            comm.guard_root([&] {
                const auto& lens = model.lens();
                folder->add(begin + rank, frames[begin + rank], {lens.width, lens.height, {image.begin(), image.end()}},
                    {lens.width, lens.height, {mask.begin(), mask.end()}});
            });
        }
        progress.report(std::int64_t(std::min(begin + ranks, frames.size())), std::ssize(frames));
    }
    progress.finish();
    comm.guard_root([&] {
        folder->finish(summary_of(request, model, frames));
        log.line(std::to_string(frames.size()) + " frames: " + (out / folder->name()).string() +
                 ", the run starts at the stamp " + format_number(request.lead + request.still) + " s");
    });
    return ExitCode::ok;
}

} // namespace treacle::app
