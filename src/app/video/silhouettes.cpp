#include "app/video/silhouettes.hpp"

#include "app/input/keep_memory.hpp"
#include "base/text/csv.hpp"
#include "base/text/file.hpp"
#include "base/text/log.hpp"
#include "base/text/progress.hpp"
#include "base/text/text.hpp"
#include "video/clip/clip_writer.hpp"
#include "video/drawing/contour_overlay.hpp"
#include "video/silhouette/silhouettes.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace treacle::app {

namespace {
using video::FrameSilhouette;

std::vector<std::string> columns() {
    return {"frame", "time [s]", "stamp [s]", "area [px]", "left [px]", "top [px]", "right [px]", "bottom [px]",
        "centroid x [px]", "centroid y [px]", "parts", "dropped specks", "dropped area [px]", "filled holes [px]",
        "excluded [px]", "shadow [px]", "faint [px]", "moved [px]", "edge width [px]", "contrast", "gain",
        "shift x [px]", "shift y [px]", "turn [rad]", "background changed"};
}

std::vector<double> row_of(const FrameSilhouette& s) {
    const auto number = [](auto value) { return static_cast<double>(value); };
    return {number(s.index), s.time, s.stamp, number(s.area), number(s.left), number(s.top), number(s.right),
        number(s.bottom), s.centre_x, s.centre_y, number(s.cleaning.parts), number(s.cleaning.specks),
        number(s.cleaning.dropped), number(s.cleaning.filled), number(s.excluded), number(s.shadow), s.faint,
        number(s.moved), s.edge_width, s.contrast, s.gain, s.shift.x, s.shift.y, s.shift.angle, s.shift.changed};
}

// A film of the frames with the contours drawn in, at the frames' stamps. Stamps that start late or are odd are kept.
class Overlay {
public:
    Overlay(const std::filesystem::path& path, const video::ClipInfo& info) {
        video::ClipOptions options;
        options.width = info.width / 2 * 2;
        options.height = info.height / 2 * 2;
        options.quality = 23;
        if (info.rate() > 0) options.frames_per_second = info.rate();
        writer_.emplace(path, options);
    }
    void add(const video::Image& frame, const FrameSilhouette& silhouette) {
        writer_->add(video::draw_contour(frame, silhouette.mask), silhouette.stamp);
    }
    void finish() { writer_->finish(); }

private:
    std::optional<video::ClipWriter> writer_;
};

struct Totals {
    std::vector<FrameSilhouette> frames; // without their masks
    double largest_shift = 0;
    std::int64_t shifted = 0;
    double faint = 0, area = 0;

    void add(FrameSilhouette&& s, int width, int height) {
        const double moved = s.shift.known ? s.shift.largest(width, height) : 0;
        if (moved > largest_shift) {
            largest_shift = moved;
            shifted = s.index;
        }
        faint += s.faint;
        area += static_cast<double>(s.area);
        s.mask = {};
        frames.push_back(std::move(s));
    }
};

void require_motion(const video::ClipInfo& info, const Totals& totals, const std::optional<video::MotionStart>& start) {
    if (start || totals.frames.size() < 2) return;
    const auto most = [&](auto&& figure) {
        std::size_t largest = 0;
        for (const auto& s : totals.frames) largest = std::max(largest, figure(s));
        return largest;
    };
    if (most([](const FrameSilhouette& s) { return s.area; }) > 0)
        throw InputError({info.file, "nothing moves in it: the silhouette stays as it is", "a flow is needed",
            "choose the clip with the experiment"});
    const auto shadow = most([](const FrameSilhouette& s) { return s.shadow; });
    if (shadow > 500)
        throw InputError(
            {info.file, "no liquid is found in it, but shadows of up to " + std::to_string(shadow) + " pixels",
                "what is darker than the background in the same colour, by less than shadow_ratio, counts as a shadow",
                "give --set shadow_ratio=1, or a value between the shadow's and the liquid's darkness"});
    throw InputError({info.file, "no liquid is found in it", "no part of a frame differs enough from the background",
        "try another method, or less of deviations, min_difference or min_area"});
}

void tell(Log& log, const video::ClipInfo& info, const Totals& totals, const std::vector<std::string>& notes,
    const std::optional<video::MotionStart>& start) {
    for (const auto& note : notes) log.line(note);
    if (info.stamps.front() != 0) log.line("the first time stamp is " + format_fixed(info.stamps.front(), 6) + " s");
    if (info.variable_rate()) log.line("the rate is variable: times are the frames' own");
    if (totals.largest_shift > 0.3)
        log.warn("the camera has moved: frames are shifted by up to " + format_fixed(totals.largest_shift, 2) +
                 " px (frame " + std::to_string(totals.shifted) + ") and were registered onto the first");
    if (totals.area > 0 && totals.faint > 0.02 * totals.area)
        log.warn(format_fixed(100 * totals.faint / totals.area, 1) +
                 " % of the liquid is faint: a reflection in the floor or a wetted film may be among it; "
                 "exclude it by a polygon (exclusions)");
    if (start)
        log.line("first moving frame: " + std::to_string(start->frame) + ", at " + format_fixed(start->time, 6) +
                 " s +- " + format_fixed(start->uncertainty, 6) + " s");
    if (start && start->frame <= totals.frames.front().index + 1)
        log.warn("the liquid moves from the first frames on: it may have started before them");
}

nlohmann::ordered_json summary_of(const video::ClipInfo& info, const Totals& totals,
    const std::vector<std::string>& notes, const std::optional<video::MotionStart>& start) {
    nlohmann::ordered_json out;
    out["clip"] = info.file;
    out["width"] = info.width;
    out["height"] = info.height;
    out["frames"] = totals.frames.size();
    out["variable_rate"] = info.variable_rate();
    out["largest_shift_px"] = totals.largest_shift;
    out["faint_share"] = totals.area > 0 ? totals.faint / totals.area : 0;
    if (start)
        out["first_moving_frame"] = {
            {"frame", start->frame}, {"time_s", start->time}, {"uncertainty_s", start->uncertainty}};
    out["notes"] = notes;
    return out;
}

void work(const SilhouettesRequest& request) {
    keep_memory();
    Log log(LogOutput::enabled);
    const auto settings = video::read_silhouette_settings(request.settings, request.changes);
    const auto source = video::open_frames(request.source);
    const auto& info = source->info();
    const auto count = std::ssize(info.stamps);
    FolderUnderWay folder(request.out, request.existing);
    log.line(info.file + ": " + info.kind + ", " + std::to_string(info.width) + " x " + std::to_string(info.height) +
             " pixels, " + std::to_string(count) + " frames");
    Progress look(log, "background", "frames"), progress(log, "silhouettes", "frames");
    video::SilhouetteMaker maker(*source, settings, [&](std::int64_t done, std::int64_t of) { look.report(done, of); });
    look.finish();
    auto table = CsvTable::create(folder.path() / "silhouettes.csv", columns());
    std::optional<Overlay> overlay;
    if (request.overlay) overlay.emplace(folder.path() / "overlay.mp4", info);
    Totals totals;
    video::TimedFrame frame;
    while (auto silhouette = maker.next(frame)) {
        video::write_mask(folder.path() / video::mask_name(silhouette->index), silhouette->mask);
        table.append(row_of(*silhouette));
        if (overlay) overlay->add(frame.image, *silhouette);
        totals.add(std::move(*silhouette), info.width, info.height);
        progress.report(std::ssize(totals.frames), count);
    }
    progress.finish();
    const auto start = video::find_motion_start(totals.frames);
    require_motion(info, totals, start);
    table.sync();
    if (overlay) overlay->finish();
    write_file_atomically(folder.path() / "settings.yaml", video::silhouette_settings_text(settings));
    write_file_atomically(
        folder.path() / "summary.json", summary_of(info, totals, maker.notes(), start).dump(2) + "\n");
    folder.finish();
    tell(log, info, totals, maker.notes(), start);
    log.line(std::to_string(totals.frames.size()) + " silhouettes: " + (request.out / "silhouettes.csv").string());
}
} // namespace

ExitCode make_silhouettes(const Comm& comm, const SilhouettesRequest& request) {
    comm.guard_root([&] { work(request); });
    return ExitCode::ok;
}

std::string silhouettes_manual() { return manual(video::SilhouetteSettings{}); }

} // namespace treacle::app
