#include "app/video_commands.hpp"

#include "app/video/check_video.hpp"
#include "app/video/film.hpp"
#include "app/video/piv_fields.hpp"
#include "app/video/silhouettes.hpp"
#include "base/text/text.hpp"

#include <CLI/CLI.hpp>

#include <array>
#include <cstdio>
#include <memory>
#include <sstream>

namespace treacle::app {

namespace {
using Command = std::function<ExitCode(const Comm&)>;

struct ClipWords {
    std::string clip, times, time_map;
    double rate = 0, true_rate = 0;
    bool allow_damage = false;

    video::SourceRequest source() const { return {clip, rate, times, true_rate, time_map, allow_damage}; }
};

void add_clip(CLI::App& app, ClipWords& words, bool required) {
    auto* clip =
        app.add_option("clip", words.clip, "Video, folder of pictures, or pattern: \"frame_%04d.png\", \"*.png\"")
            ->type_name("CLIP");
    if (required) clip->required();
    app.add_option("--rate", words.rate, "Frames per second of pictures")->check(CLI::PositiveNumber)->type_name("HZ");
    app.add_option("--times", words.times, "CSV with a column time [s], a row for each picture, in place of a rate")
        ->type_name("FILE");
    app.add_option("--true-rate", words.true_rate,
           "Frames per second at which slow motion was shot, where the file has a steady rate")
        ->check(CLI::PositiveNumber)
        ->type_name("HZ");
    app.add_option("--time-map", words.time_map,
           "True times by pieces: \"STAMP:TIME STAMP:TIME ...\" [s], or a CSV file with columns stamp, time")
        ->type_name("MAP");
    app.add_flag("--allow-damage", words.allow_damage, "Take the whole frames of a clip that is cut off");
}

// Options that are short for a key of the settings.
struct Short {
    const char* option;
    const char* key;
    const char* doc;
};
constexpr Short shorts[] = {
    {"--method", "method", "gmm (default), difference, threshold, colour or masks"},
    {"--empty-frames", "empty.frames", "Frames without liquid, as 0:59 (default: those before the first change)"},
    {"--empty-picture", "empty.picture", "Picture without liquid"},
    {"--empty-clip", "empty.clip", "Clip without liquid"},
    {"--colour,--color", "colour", "Of the liquid, for --method colour: \"[r, g, b]\" of 255"},
    {"--level", "level", "Grey level of 255, for --method threshold (default: Otsu's)"},
    {"--region", "region", "Polygon \"x,y x,y x,y\" or picture outside which nothing counts"},
    {"--start", "start", "Polygon that the liquid touches first; parts that touch neither it nor liquid are dropped"},
    {"--closing", "closing", "Radius of the closing [px] (default 2)"},
    {"--opening", "opening", "Radius of the opening [px] (default 2)"},
};

void add_silhouettes(CLI::App& program, const ChooseCommand& choose) {
    struct SilhouetteWords : ClipWords {
        std::string out, settings;
        std::vector<std::string> values = std::vector<std::string>(std::size(shorts)), changes;
        bool overwrite = false, no_overlay = false, keys = false;
    };
    auto words = std::make_shared<SilhouetteWords>();
    auto& app = *program.add_subcommand("silhouettes",
        "Silhouettes of the liquid from a video, pictures, or ready-made masks: a PNG mask for each "
        "frame, silhouettes.csv, settings.yaml, and a film with the contours drawn in.");
    add_clip(app, *words, false);
    for (std::size_t i = 0; i < std::size(shorts); ++i)
        app.add_option(shorts[i].option, words->values[i], shorts[i].doc)->type_name("VALUE");
    app.add_option("--settings", words->settings, "YAML with these and more keys, as settings.yaml of an earlier call")
        ->type_name("FILE");
    app.add_option("--set", words->changes, "Override a key of the settings: a.b=value. May be given several times.")
        ->allow_extra_args(false);
    app.add_flag("--keys", words->keys, "Print the manual of the settings");
    app.add_option("--out", words->out, "Folder (default: silhouettes)")->type_name("DIR");
    app.add_flag("--overwrite", words->overwrite, "Replace the folder");
    app.add_flag("--no-overlay", words->no_overlay, "Leave out the film with contours");
    app.callback([words, choose] {
        choose([words]() -> Command {
            if (words->keys)
                return [](const Comm& comm) {
                    if (comm.is_root()) std::fputs(silhouettes_manual().c_str(), stdout);
                    return ExitCode::ok;
                };
            if (words->clip.empty())
                throw InputError(
                    {"treacle silhouettes", "CLIP is required", "", "name a video, a folder or a pattern"});
            SilhouettesRequest request;
            request.source = words->source();
            request.out = words->out.empty() ? "silhouettes" : words->out;
            request.settings = words->settings;
            for (std::size_t i = 0; i < std::size(shorts); ++i)
                if (!words->values[i].empty())
                    request.changes.push_back(std::string(shorts[i].key) + "=" + words->values[i]);
            if (!words->values[7].empty()) request.changes.push_back("keep=connected");
            request.changes.insert(request.changes.end(), words->changes.begin(), words->changes.end());
            request.existing = words->overwrite ? ExistingFolder::replace : ExistingFolder::refuse;
            request.overlay = !words->no_overlay;
            return [request](const Comm& comm) { return make_silhouettes(comm, request); };
        });
    });
}

void add_check_video(CLI::App& program, const ChooseCommand& choose) {
    struct CheckWords : ClipWords {
        std::string json, camera;
        std::vector<double> at = {0, 0, 0};
    };
    auto words = std::make_shared<CheckWords>();
    auto& app = *program.add_subcommand("check-video",
        "What a clip is like and what is wrong with it, before anything is run: stamps, rotation, exposure, "
        "camera motion, contrast. Exit code 2 where it cannot be used.");
    add_clip(app, *words, true);
    app.add_option("--json", words->json, "Write the figures into this file")->type_name("FILE");
    auto* camera = app.add_option("--camera", words->camera,
                          "Camera file with a pose, or FILE:NAME: says the pixels per millimetre")
                       ->type_name("FILE");
    app.add_option("--at", words->at, "Where the liquid is in the scene, x y z [m] (default 0 0 0)")
        ->expected(3)
        ->needs(camera)
        ->type_name("X Y Z");
    app.callback([words, choose] {
        choose([words]() -> Command {
            return [request = CheckVideoRequest{words->source(), words->json, words->camera,
                        {words->at[0], words->at[1], words->at[2]}}](
                       const Comm& comm) { return check_video(comm, request); };
        });
    });
}

struct FilmWords {
    std::string run, camera, out, codec = "h264", time_map, liquid, background;
    double exposure_fraction = 0.25;
    bool overwrite = false;
    FilmRequest request;
};

// "0.6,0.62,0.65": light of red, green and blue, 1 is white.
void read_light(const std::string& option, const std::string& text, std::array<double, 3>& light) {
    if (text.empty()) return;
    std::istringstream words(text);
    std::size_t count = 0;
    bool good = true;
    for (std::string word; std::getline(words, word, ',') && count < 3; ++count) {
        const auto value = read_number(word);
        good = good && value && *value >= 0 && *value <= 1;
        if (good) light[count] = *value;
    }
    if (good && count == 3) return;
    throw InputError({option + " " + text, "is no light", "it takes red, green and blue from 0 to 1",
        "write for instance 0.6,0.62,0.65"});
}

FilmRequest film_request(const FilmWords& words) {
    auto request = words.request;
    request.run = words.run;
    request.camera = words.camera;
    request.out = words.out;
    request.time_map = words.time_map;
    request.existing = words.overwrite ? ExistingFolder::replace : ExistingFolder::refuse;
    request.codec = words.codec == "h264"       ? video::ClipCodec::h264
                    : words.codec == "lossless" ? video::ClipCodec::h264_lossless
                                                : video::ClipCodec::ffv1;
    if (request.shot.exposure < 0) request.shot.exposure = words.exposure_fraction / request.rate;
    request.shot.instants = request.shot.exposure > 0 ? 5 : 1;
    read_light("--liquid", words.liquid, request.shot.colour);
    read_light("--background", words.background, request.look.background);
    return request;
}

void add_film_times(CLI::App& app, FilmRequest& r) {
    app.add_option("--lead", r.lead, "Seconds of the empty scene before the run (default 1)")
        ->check(CLI::NonNegativeNumber)
        ->type_name("S");
    app.add_option("--still", r.still, "Seconds of the liquid at rest in the run's first frame (default 0)")
        ->check(CLI::NonNegativeNumber)
        ->type_name("S");
    app.add_option("--from", r.first, "First time of the run [s] (default: its start)")
        ->check(CLI::NonNegativeNumber)
        ->type_name("S");
    app.add_option("--to", r.last, "Last time of the run [s] (default: its end)")
        ->check(CLI::NonNegativeNumber)
        ->type_name("S");
    app.add_option("--phase", r.phase, "Of the frames against the run's start, in intervals (default 0)")
        ->check(CLI::Range(0.0, 1.0))
        ->type_name("SHARE");
}

void add_film_look(CLI::App& app, FilmRequest& r) {
    app.add_option("--blur", r.look.blur, "Blur of the lens, a standard deviation in pixels (default 0.8)")
        ->type_name("PX");
    app.add_option("--noise", r.look.noise, "Standard deviation in grey levels of 255 (default 1.5)")
        ->type_name("LEVELS");
    app.add_option("--texture", r.look.texture, "Amplitude of the background's pattern, relative (default 0.15)")
        ->check(CLI::Range(0.0, 1.0))
        ->type_name("SHARE");
    app.add_option("--uneven", r.look.uneven_light, "Fall of the light to the corners, relative (default 0.1)")
        ->check(CLI::Range(0.0, 1.0))
        ->type_name("SHARE");
    app.add_option("--drift", r.look.exposure_drift, "The exposure goes up and down by this, relative (default 0)")
        ->type_name("SHARE");
    app.add_option("--shadow", r.look.shadow, "Darkness of a soft shadow beside the liquid (default 0)")
        ->check(CLI::Range(0.0, 1.0))
        ->type_name("SHARE");
}

void add_film(CLI::App& program, const ChooseCommand& choose) {
    auto words = std::make_shared<FilmWords>();
    auto& app = *program.add_subcommand("film",
        "A video of a run as a camera would film it, with the exact mask of each frame beside it: textured background, "
        "noise, blur, uneven light, drifting exposure. Frames are shared out over ranks.");
    auto& r = words->request;
    r.shot.exposure = -1;
    app.add_option("run", words->run, "Folder of a run")->required()->type_name("DIR");
    app.add_option("--camera", words->camera, "A camera of the scene, or a camera file (default: the first one)")
        ->type_name("NAME|FILE");
    app.add_option("--see-through", r.see_through, "A body of clear material. May be given several times.")
        ->allow_extra_args(false)
        ->type_name("BODY");
    app.add_option("--out", words->out, "Folder (default: film/ in that of the run)")->type_name("DIR");
    app.add_flag("--overwrite", words->overwrite, "Replace the folder");
    app.add_option("--codec", words->codec, "h264 (default), lossless (H.264) or ffv1 (MKV)")
        ->check(CLI::IsMember({"h264", "lossless", "ffv1"}))
        ->type_name("CODEC");
    app.add_option("--quality", r.quality, "Of h264: 0 best, 51 worst (default 16)")
        ->check(CLI::Range(0.0, 51.0))
        ->type_name("NUMBER");
    app.add_option("--rate", r.rate, "Frames per second (default 30)")->type_name("HZ");
    app.add_option("--jitter", r.jitter, "Random part of the intervals, relative: a variable rate (default 0)")
        ->type_name("SHARE");
    app.add_option("--time-map", words->time_map,
           "Slow motion with a ramp: \"STAMP:TIME STAMP:TIME ...\" [s], as of silhouettes")
        ->type_name("MAP");
    add_film_times(app, r);
    app.add_option(
           "--turned", r.turned, "The file is stored turned back by 90, 180 or 270 degrees; its display matrix says so")
        ->check(CLI::IsMember({0, 90, 180, 270}))
        ->type_name("DEG");
    app.add_option(
           "--exposure", r.shot.exposure, "Seconds that motion is blurred over (default: a quarter of the interval)")
        ->check(CLI::NonNegativeNumber)
        ->type_name("S");
    app.add_option(
           "--readout", r.shot.readout, "Seconds from the first to the last row of a rolling shutter (default 0)")
        ->check(CLI::NonNegativeNumber)
        ->type_name("S");
    add_film_look(app, r);
    app.add_option(
           "--liquid", words->liquid, "Light of the liquid, red, green, blue from 0 to 1 (default 0.05,0.04,0.03)")
        ->type_name("R,G,B");
    app.add_option("--background", words->background, "Light of the background (default 0.6,0.62,0.65)")
        ->type_name("R,G,B");
    app.add_option("--seed", r.look.seed, "Of texture, noise and jitter (default 1)")->type_name("NUMBER");
    app.callback([words, choose] {
        choose([words]() -> Command {
            return [request = film_request(*words)](const Comm& comm) { return film_run(comm, request); };
        });
    });
}

struct PivWords {
    std::string run, out;
    std::vector<double> origin, right = {1, 0, 0}, up = {0, 0, 1}, size;
    PivRequest request;
};

PivRequest piv_request(const PivWords& words) {
    auto request = words.request;
    request.run = words.run;
    request.out = words.out.empty() ? std::filesystem::path(words.run) / "piv" : std::filesystem::path(words.out);
    std::copy_n(words.origin.begin(), 3, request.sheet.origin.begin());
    std::copy_n(words.right.begin(), 3, request.sheet.right.begin());
    std::copy_n(words.up.begin(), 3, request.sheet.up.begin());
    request.width = words.size[0];
    request.height = words.size[1];
    return request;
}

void add_piv(CLI::App& program, const ChooseCommand& choose) {
    auto words = std::make_shared<PivWords>();
    auto& app = *program.add_subcommand("piv",
        "Velocity fields that PIV would measure in a sheet through a run, as CSV: means over interrogation windows, "
        "noise that overlapping windows share, outliers, no vectors at bodies.");
    auto& r = words->request;
    app.add_option("run", words->run, "Folder of a run")->required()->type_name("DIR");
    app.add_option("--out", words->out, "Folder (default: piv/ in that of the run)")->type_name("DIR");
    app.add_option("--origin", words->origin, "Lower left corner of the sheet, x y z [m]")
        ->required()
        ->expected(3)
        ->type_name("X Y Z");
    app.add_option("--right", words->right, "Unit vector to the right (default 1 0 0)")
        ->expected(3)
        ->type_name("X Y Z");
    app.add_option("--up", words->up, "Unit vector up (default 0 0 1)")->expected(3)->type_name("X Y Z");
    app.add_option("--size", words->size, "Width and height [m]")->required()->expected(2)->type_name("W H");
    app.add_option("--step", r.step, "Distance of vectors [m]")->required()->check(CLI::PositiveNumber)->type_name("M");
    app.add_option("--window", r.sheet.window, "Side of an interrogation window [m]")
        ->required()
        ->check(CLI::PositiveNumber)
        ->type_name("M");
    app.add_option("--from", r.first, "Time of the first field [s] (default 0)")
        ->check(CLI::NonNegativeNumber)
        ->type_name("S");
    app.add_option("--to", r.last, "Last time [s] (default: the run's end)")
        ->check(CLI::NonNegativeNumber)
        ->type_name("S");
    app.add_option("--interval", r.interval, "Time from one field to the next [s]")
        ->required()
        ->check(CLI::PositiveNumber)
        ->type_name("S");
    app.add_option("--noise", r.noise, "Standard deviation of a component over the largest speed (default 0)")
        ->check(CLI::Range(0.0, 1.0))
        ->type_name("SHARE");
    app.add_option("--outliers", r.outliers, "Share of vectors that point anywhere (default 0)")
        ->check(CLI::Range(0.0, 1.0))
        ->type_name("SHARE");
    app.add_option("--track", r.track, "Body whose path is written into track.csv")->type_name("NAME");
    app.add_option("--track-noise", r.track_noise, "Standard deviation of that path [m] (default 0)")
        ->check(CLI::NonNegativeNumber)
        ->type_name("M");
    app.add_option("--seed", r.seed, "Of noise and outliers (default 1)")->type_name("NUMBER");
    app.callback([words, choose] {
        choose([words]() -> Command {
            return [request = piv_request(*words)](const Comm& comm) { return make_piv_fields(comm, request); };
        });
    });
}
} // namespace

void add_video_commands(CLI::App& program, const ChooseCommand& choose) {
    add_check_video(program, choose);
    add_silhouettes(program, choose);
    add_film(program, choose);
    add_piv(program, choose);
}

} // namespace treacle::app
