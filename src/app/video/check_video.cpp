#include "app/video/check_video.hpp"

#include "app/input/camera_files.hpp"
#include "app/input/keep_memory.hpp"
#include "base/text/file.hpp"
#include "base/text/log.hpp"
#include "base/text/progress.hpp"
#include "base/text/text.hpp"
#include "video/silhouette/clip_check.hpp"

#include <nlohmann/json.hpp>

namespace treacle::app {

namespace {
using video::FindingKind;

const char* name_of(FindingKind kind) {
    return kind == FindingKind::problem ? "problem" : kind == FindingKind::warning ? "warning" : "note";
}

void print_figures(Log& log, const video::ClipInfo& info, const video::ClipCheck& check) {
    const auto line = [&](const std::string& name, const std::string& value) {
        log.line("  " + name + std::string(name.size() < 22 ? 22 - name.size() : 1, ' ') + value);
    };
    log.line(info.file + ": " + info.kind);
    line("size", std::to_string(info.width) + " x " + std::to_string(info.height) + " pixels, " +
                     (info.width >= info.height ? "landscape" : "portrait") + ", turned by " +
                     std::to_string(info.orientation.degrees()) + " degrees");
    line("frames", std::to_string(info.stamps.size()) + ", " + format_fixed(info.stamps.front(), 3) + " to " +
                       format_fixed(info.stamps.back(), 3) + " s");
    line("rate", format_fixed(info.rate(), 3) + " Hz, " + (info.variable_rate() ? "variable" : "constant"));
    if (info.times.back() != info.stamps.back())
        line("true times", format_fixed(info.times.front(), 4) + " to " + format_fixed(info.times.back(), 4) + " s");
    line("doubled, dropped", std::to_string(check.doubled.size()) + ", " + std::to_string(check.dropped) + " frames");
    line("brightness", format_fixed(check.brightness_low, 3) + " to " + format_fixed(check.brightness_high, 3) +
                           " of the first frame, flicker " + format_fixed(check.flicker, 4));
    line("camera", check.registered ? "moves by " + format_fixed(check.largest_shift, 2) + " px at most"
                                    : "not followed: too little texture");
    line("noise", format_fixed(check.noise, 2) + " grey levels of 255");
    if (check.first_change)
        line("first change", "frame " + std::to_string(*check.first_change) + ", up to " +
                                 format_fixed(100 * check.moving_area, 1) + " % of the picture");
    if (check.contrast > 0)
        line("contour", "contrast " + format_fixed(check.contrast, 1) + " grey levels of 255, blur " +
                            format_fixed(check.edge_width, 2) + " px");
}

nlohmann::ordered_json json_of(const video::ClipInfo& info, const video::ClipCheck& check) {
    nlohmann::ordered_json out;
    out["clip"] = info.file;
    out["kind"] = info.kind;
    out["usable"] = check.usable();
    out["width"] = info.width;
    out["height"] = info.height;
    out["turned_degrees"] = info.orientation.degrees();
    out["bits"] = info.bits;
    out["frames"] = info.stamps.size();
    out["first_stamp_s"] = info.stamps.front();
    out["last_stamp_s"] = info.stamps.back();
    out["rate_hz"] = info.rate();
    out["variable_rate"] = info.variable_rate();
    out["doubled"] = check.doubled;
    out["dropped"] = check.dropped;
    out["brightness"] = {check.brightness_low, check.brightness_high};
    out["flicker"] = check.flicker;
    out["registered"] = check.registered;
    out["camera_shift_px"] = check.largest_shift;
    out["background_changed"] = check.largest_changed;
    out["noise"] = check.noise;
    if (check.first_change) out["first_change"] = *check.first_change;
    out["moving_area"] = check.moving_area;
    out["contrast"] = check.contrast;
    out["edge_width_px"] = check.edge_width;
    out["clipped"] = check.clipped;
    for (const auto& finding : check.findings)
        out["findings"].push_back({{"kind", name_of(finding.kind)}, {"text", finding.text}, {"cure", finding.cure}});
    return out;
}

// Pixels per millimetre across the line of sight at a point of the scene; a camera that does not fit is a finding.
double scale_of(const CheckVideoRequest& request, const video::ClipInfo& info, video::ClipCheck& check) {
    const auto model = camera_of_file(request.camera).model();
    const auto& lens = model.lens();
    if (lens.width != info.width || lens.height != info.height) {
        check.findings.insert(check.findings.begin(),
            {FindingKind::problem,
                "the camera is for " + std::to_string(lens.width) + " x " + std::to_string(lens.height) + " pixels",
                "calibrate with a clip of the same mode and orientation"});
        return 0;
    }
    const auto seen = model.project(request.at);
    if (seen.depth <= scene::CameraModel::near_plane || seen.x < -0.5 || seen.y < -0.5 || seen.x > info.width - 0.5 ||
        seen.y > info.height - 0.5) {
        check.findings.insert(check.findings.begin(),
            {FindingKind::problem, "the camera does not see the point of --at", "give a point in the liquid"});
        return 0;
    }
    return 0.5 * (lens.fx + lens.fy) / seen.depth / 1000;
}

bool work(const CheckVideoRequest& request) {
    keep_memory();
    Log log(LogOutput::enabled);
    auto source_request = request.source;
    source_request.allow_damage = true; // the check names it
    const auto source = video::open_any_frames(source_request);
    Progress progress(log, "check-video", "frames");
    auto check = video::check_clip(*source, [&](std::int64_t done, std::int64_t of) { progress.report(done, of); });
    progress.finish();
    const double scale = request.camera.empty() ? 0 : scale_of(request, source->info(), check);
    print_figures(log, source->info(), check);
    if (scale > 0)
        log.line("  scale                 " + format_fixed(scale, 3) + " px per mm at " +
                 format_fixed(request.at[0], 3) + ", " + format_fixed(request.at[1], 3) + ", " +
                 format_fixed(request.at[2], 3) + " m: 0.2 px of contour are " + format_fixed(0.2 / scale, 3) + " mm");
    for (const auto& finding : check.findings) {
        if (finding.kind == FindingKind::problem && request.source.allow_damage &&
            finding.text.starts_with("is cut off"))
            continue;
        log.line(std::string(name_of(finding.kind)) + ": " + finding.text +
                 (finding.cure.empty() ? "" : "; " + finding.cure) + ".");
    }
    const bool usable = check.usable();
    log.line(usable ? "the clip can be used" : "the clip cannot be used as it is");
    auto figures = json_of(source->info(), check);
    if (scale > 0) figures["px_per_mm"] = scale;
    if (!request.json.empty()) write_file_atomically(request.json, figures.dump(2) + "\n");
    return usable;
}
} // namespace

ExitCode check_video(const Comm& comm, const CheckVideoRequest& request) {
    std::string usable = "yes";
    comm.guard_root([&] { usable = work(request) ? "yes" : "no"; });
    return comm.broadcast(usable) == "yes" ? ExitCode::ok : ExitCode::bad_input;
}

} // namespace treacle::app
