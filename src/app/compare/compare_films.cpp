#include "app/compare/compare_films.hpp"

#include "app/render/picture.hpp"
#include "app/render/scenery.hpp"
#include "app/setup/bodies.hpp"
#include "base/text/error.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"
#include "identify/compare/residual_file.hpp"
#include "video/camera/camera_file.hpp"
#include "video/mask/mask.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace treacle::app {

namespace {
using identify::Experiment;
using identify::StudyFile;

constexpr double same_frame = 1e-6; // [s] between masks that share a frame of the run

// A comparison as numbers, to be sent.
std::vector<double> packed(const identify::FrameComparison& one) {
    std::vector<double> out{double(one.mismatches), double(one.observed), double(one.simulated), double(one.compared),
        one.beyond, double(one.segments.size())};
    for (const auto& s : one.segments) {
        out.insert(out.end(), {double(s.frame), s.time, s.x, s.y, s.normal_x, s.normal_y, s.points, s.displacement});
        out.insert(out.end(), s.by_view.begin(), s.by_view.end());
    }
    return out;
}

identify::FrameComparison unpacked(const double*& at) {
    identify::FrameComparison out;
    out.mismatches = std::int64_t(*at++);
    out.observed = std::int64_t(*at++);
    out.simulated = std::int64_t(*at++);
    out.compared = std::int64_t(*at++);
    out.beyond = *at++;
    const auto count = std::size_t(*at++);
    for (std::size_t i = 0; i < count; ++i) {
        identify::SegmentResidual s{int(at[0]), at[1], at[2], at[3], at[4], at[5], at[6], at[7], {}};
        at += 8;
        std::copy_n(at, s.by_view.size(), s.by_view.begin());
        at += s.by_view.size();
        out.segments.push_back(s);
    }
    return out;
}

// All on which a comparison of occupancy depends beside the masks. Throws InputError where windows have too few masks.
std::string occupancy_content(const Experiment& experiment, std::size_t frames) {
    constexpr std::size_t least = 8; // masks of a window
    const auto& occupancy = experiment.occupancy;
    if (frames < least * std::size_t(occupancy.windows)) {
        throw InputError({experiment.where,
            "occupancy.windows = " + std::to_string(occupancy.windows) + ", of " + std::to_string(frames) + " masks",
            "a window needs " + std::to_string(least) + " masks or more, over a turn or several",
            "take fewer windows, or more of the film"});
    }
    std::string out = " occupancy " + std::to_string(occupancy.windows) + " mirror " +
                      std::to_string(int(occupancy.mirror)) + " at " + format_number(occupancy.mirror_at);
    for (const double level : occupancy.levels) out += " " + format_number(level);
    return out;
}
} // namespace

ExperimentCamera experiment_camera(const StudyFile& file, const Experiment& experiment, const Input& input) {
    auto path = file.beside(experiment.camera);
    std::string name;
    if (const auto colon = experiment.camera.rfind(':'); !std::filesystem::exists(path) && colon != std::string::npos) {
        path = file.beside(experiment.camera.substr(0, colon));
        name = experiment.camera.substr(colon + 1);
    }
    if (experiment.camera.empty() || !std::filesystem::is_regular_file(path)) {
        try {
            const auto camera = find_camera(input.scene, experiment.camera);
            return {video::camera_model(view_of(camera, input.scene.domain, {}), camera.name), {}, 0};
        } catch (const InputError& error) {
            throw InputError({experiment.where,
                "camera = " + experiment.camera + " is neither a file nor a camera of the scene", error.what(), ""});
        }
    }
    auto record = video::read_camera(path, name);
    if (record.any_size) {
        const auto first = identify::observed_frames(experiment, file.beside(experiment.masks)).front().mask;
        const auto mask = video::read_mask(first);
        record = video::for_pictures(record, mask.width, mask.height, first.string());
    }
    ExperimentCamera out{record.model(), {}, 0};
    if (record.pose_covariance)
        out.pose_covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6>>(record.pose_covariance->data());
    if (record.covariance) out.focal_deviation = record.covariance->deviation(0) / record.lens.fx;
    return out;
}

FilmComparison::FilmComparison(
    const Comm& comm, const StudyFile& file, const Experiment& experiment, std::filesystem::path folder)
    : comm_(comm), file_(file), experiment_(experiment), folder_(std::move(folder)),
      masks_(folder_ / ("masks_" + experiment.name)) {
    comm_.guard([&] { frames_ = identify::observed_frames(experiment_, file_.beside(experiment_.masks)); });
}

void FilmComparison::look_at(const RunView& run) {
    if (film_ && drawn_ == &run && !any_moves(run.input)) return; // else bodies are elsewhere by now
    comm_.guard([&] { film_.emplace(file_, experiment_, run); });
    comm_.guard_root([&] { std::filesystem::create_directories(masks_); });
    drawn_ = &run;
}

void FilmComparison::compare_up_to(const RunView& run) {
    const double up_to = run.frames.back().time + same_frame;
    const auto due =
        std::size_t(std::ranges::upper_bound(frames_, up_to, {}, &identify::ObservedFrame::time) - frames_.begin());
    const auto turn = std::size_t(comm_.size());
    if (residuals_.frames.size() + turn > due) return;
    look_at(run);
    while (residuals_.frames.size() + turn <= due) compare_turn();
}

void FilmComparison::complete(const RunView& run) {
    look_at(run);
    while (residuals_.frames.size() < frames_.size()) compare_turn();
    residuals_.observed = frames_;
    comm_.guard_root([&] { identify::write_residuals(folder_, experiment_.name, residuals_); });
}

void FilmComparison::compare_turn() {
    const auto mine = residuals_.frames.size() + std::size_t(comm_.rank());
    std::vector<double> numbers;
    comm_.guard([&] {
        if (mine >= frames_.size()) return;
        const auto simulated = film_->draw(mine);
        video::write_mask(masks_ / frames_[mine].mask.filename(), simulated.now.mask);
        numbers = packed(
            identify::compare_frame(frames_[mine], video::read_mask(frames_[mine].mask), simulated, film_->camera()));
    });
    const auto all = comm_.all_gather(std::span<const double>(numbers));
    for (const double* at = all.data(); at < all.data() + all.size();) {
        auto one = unpacked(at);
        residuals_.segments.insert(residuals_.segments.end(), one.segments.begin(), one.segments.end());
        one.segments.clear();
        residuals_.frames.push_back(std::move(one));
    }
}

identify::FilmMismatches FilmComparison::mismatches() const {
    identify::FilmMismatches out;
    out.masks = frames_.size();
    for (std::size_t i = 0; i < residuals_.frames.size(); ++i) {
        out.times.push_back(frames_[i].time);
        out.mismatches.push_back(identify::mismatch_objective(residuals_.frames[i]));
    }
    if (out.times.size() < frames_.size()) out.next = frames_[out.times.size()].time;
    return out;
}

ObservationNeeds film_needs(const StudyFile& file, const Experiment& experiment, const Input& input) {
    const auto frames = identify::observed_frames(experiment, file.beside(experiment.masks));
    const auto camera = experiment_camera(file, experiment, input).model;
    check_end(experiment.where, experiment.name, frames.back().time, input.scene.time.end);
    const auto mask = video::read_mask(frames.front().mask);
    if (mask.width != camera.lens().width || mask.height != camera.lens().height) {
        throw InputError({experiment.where,
            frames.front().mask.string() + " has " + std::to_string(mask.width) + " x " + std::to_string(mask.height) +
                " pixels",
            "the camera's pictures have " + std::to_string(camera.lens().width) + " x " +
                std::to_string(camera.lens().height),
            "give the camera of these pictures"});
    }
    require_bodies(input, experiment.see_through, experiment.where);
    ObservationNeeds out;
    for (const auto& frame : frames) out.times.push_back(frame.time);
    const auto& pose = camera.pose();
    const auto& lens = camera.lens();
    out.content = "film " + experiment.name;
    if (experiment.readout > 0) out.content += " readout " + format_number(experiment.readout);
    if (experiment.kind == identify::ExperimentKind::occupancy)
        out.content += occupancy_content(experiment, frames.size());
    for (const auto& name : experiment.see_through) out.content += " through " + name;
    for (const double v : {lens.fx, lens.fy, lens.cx, lens.cy}) out.content += " " + format_number(v);
    for (const double v : lens.distortion) out.content += " " + format_number(v);
    for (const auto& row : pose.rotation) {
        for (const double v : row) out.content += " " + format_number(v);
    }
    for (const double v : pose.translation) out.content += " " + format_number(v);
    for (const auto& frame : frames) out.content += " " + format_number(frame.time) + read_file(frame.mask);
    return out;
}

} // namespace treacle::app
