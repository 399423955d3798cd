#include "app/video_commands.hpp"

#include "app/check_video.hpp"
#include "app/silhouettes.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>

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
    auto* clip = app.add_option("clip", words.clip, "Video, folder of pictures, or pattern: \"frame_%04d.png\", \"*.png\"")->type_name("CLIP");
    if (required) clip->required();
    app.add_option("--rate", words.rate, "Frames per second of pictures")->check(CLI::PositiveNumber)->type_name("HZ");
    app.add_option("--times", words.times, "CSV with a column time [s], a row for each picture, in place of a rate")->type_name("FILE");
    app.add_option("--true-rate", words.true_rate, "Frames per second at which slow motion was shot, where the file has a steady rate")
        ->check(CLI::PositiveNumber)
        ->type_name("HZ");
    app.add_option("--time-map", words.time_map, "True times by pieces: \"STAMP:TIME STAMP:TIME ...\" [s], or a CSV file with columns stamp, time")
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
    auto& app = *program.add_subcommand("silhouettes", "Silhouettes of the liquid from a video, pictures, or ready-made masks: a PNG mask for each "
                                                       "frame, silhouettes.csv, settings.yaml, and a film with the contours drawn in.");
    add_clip(app, *words, false);
    for (std::size_t i = 0; i < std::size(shorts); ++i) app.add_option(shorts[i].option, words->values[i], shorts[i].doc)->type_name("VALUE");
    app.add_option("--settings", words->settings, "YAML with these and more keys, as settings.yaml of an earlier call")->type_name("FILE");
    app.add_option("--set", words->changes, "Override a key of the settings: a.b=value. May be given several times.")->allow_extra_args(false);
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
                throw InputError({"treacle silhouettes", "CLIP is required", "", "name a video, a folder or a pattern"});
            SilhouettesRequest request;
            request.source = words->source();
            request.out = words->out.empty() ? "silhouettes" : words->out;
            request.settings = words->settings;
            for (std::size_t i = 0; i < std::size(shorts); ++i)
                if (!words->values[i].empty()) request.changes.push_back(std::string(shorts[i].key) + "=" + words->values[i]);
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
        std::string json;
    };
    auto words = std::make_shared<CheckWords>();
    auto& app = *program.add_subcommand("check-video", "What a clip is like and what is wrong with it, before anything is run: stamps, rotation, exposure, "
                                                       "camera motion, contrast. Exit code 2 where it cannot be used.");
    add_clip(app, *words, true);
    app.add_option("--json", words->json, "Write the figures into this file")->type_name("FILE");
    app.callback([words, choose] {
        choose([words]() -> Command {
            return [request = CheckVideoRequest{words->source(), words->json}](const Comm& comm) { return check_video(comm, request); };
        });
    });
}
} // namespace

void add_video_commands(CLI::App& program, const ChooseCommand& choose) {
    add_check_video(program, choose);
    add_silhouettes(program, choose);
}

} // namespace treacle::app
