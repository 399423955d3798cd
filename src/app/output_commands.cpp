#include "app/subcommands.hpp"

#include "app/export/export_frames.hpp"
#include "app/export/export_surface.hpp"
#include "app/input/option_values.hpp"
#include "app/render/liquid_picture.hpp"
#include "app/render/render.hpp"

#include <memory>

namespace treacle::app {

namespace {
constexpr const char* frames_doc = "first:last:stride, from 0, last included, negative from the end";
} // namespace

void add_export(CLI::App& program, Chosen& chosen) {
    struct ExportWords {
        std::string source, format, mesh_format, frames, out, liquid, fields, box;
        double min_volume = 0;
        bool check = false;
    };
    auto words = std::make_shared<ExportWords>();
    auto& app =
        *program.add_subcommand("export", "Convert frames for other programs; frames are shared out over ranks.");
    app.add_option("source", words->source, "Folder of a run, or one frame")->required()->type_name("DIR|FRAME");
    app.add_option("--to", words->format, "Particles: ply, vtp or csv; surface: the liquid's surface as a closed mesh")
        ->required()
        ->type_name("FORMAT");
    app.add_option("--format", words->mesh_format, "surface: ply (default), obj or vtp")->type_name("FORMAT");
    app.add_option("--min-volume", words->min_volume,
           "surface: leave out pieces and cavities smaller than so many particles (default 0: keep all)")
        ->check(CLI::Range(0.0, 1e9))
        ->type_name("NUMBER");
    app.add_option("--liquid", words->liquid,
           "surface: that of one liquid of several, or each in files of its own (default: all together as one)")
        ->type_name("NAME|each");
    app.add_option("--fields", words->fields,
           "surface: what vertices carry, such as normal,velocity,density; none (default: "
           "normal,velocity,pressure,liquid)")
        ->type_name("LIST");
    app.add_option(
           "--box", words->box, "surface: only the part in a box, closed at its sides: \"0 0 0 cm; 10 10 5 cm\"")
        ->type_name("CORNERS");
    app.add_flag("--check", words->check,
        "surface: count edges and vertices at which the mesh is not closed, oriented or a manifold; exit code 3 if "
        "there are any");
    app.add_option("--frames", words->frames, frames_doc)->type_name("A:B:C");
    app.add_option("--out", words->out, "Folder (default: exports/ in that of the run, or beside the frame)")
        ->type_name("DIR");
    app.callback([words, &chosen] {
        chosen.make = [words]() -> Command {
            return [words](const Comm& comm) {
                if (words->format == "surface") {
                    return export_surface(comm,
                        {words->source, words->mesh_format.empty() ? "ply" : words->mesh_format, words->frames,
                            words->out, words->min_volume, words->liquid, words->fields, words->box, words->check});
                }
                const std::pair<bool, const char*> of_surfaces[] = {{!words->mesh_format.empty(), "--format"},
                    {words->min_volume > 0, "--min-volume"}, {!words->liquid.empty(), "--liquid"},
                    {!words->fields.empty(), "--fields"}, {!words->box.empty(), "--box"}, {words->check, "--check"}};
                for (const auto& [given, option] : of_surfaces)
                    if (given)
                        throw InputError({option, "has no effect", "it belongs to --to surface",
                            "write --to surface, or leave it out"});
                return export_frames(comm, {words->source, words->format, words->frames, words->out});
            };
        };
    });
}

namespace {
struct RenderWords {
    std::string folder, field = "speed", map = "viridis", range, camera, style = "spheres", background = "white";
    std::string frames, size, movie, out, cut;
    Words colours;
    double frames_per_second = 0;
    bool no_movie = false;
};

void check_colouring(const RenderRequest& request) {
    if (request.field == no_field && request.style == Style::spheres)
        throw InputError({"--field none", "leaves balls without a colour",
            "liquids have colours of their own with --style surface only", "add it, or name a field"});
}

RenderRequest render_request(const RenderWords& words) {
    RenderRequest request;
    request.folder = words.folder;
    request.field = words.field;
    request.map = words.map == "viridis" ? video::ColourMap::viridis : video::ColourMap::diverging;
    if (!words.range.empty()) request.range = read_value_range(words.range);
    request.camera = words.camera;
    request.style = words.style == "spheres" ? Style::spheres : Style::surface;
    if (!words.cut.empty()) request.cut = read_cut(words.cut);
    check_colouring(request);
    request.background = words.background == "white" ? video::Background::white : video::Background::dark;
    request.colours = words.colours;
    request.frames = words.frames;
    request.frames_per_second = words.frames_per_second;
    if (!words.size.empty()) request.size = read_picture_size(words.size);
    request.movie = words.no_movie ? Movie::leave_out : Movie::write;
    request.movie_file = words.movie;
    request.out = words.out;
    return request;
}
} // namespace

void add_render(CLI::App& program, Chosen& chosen) {
    auto words = std::make_shared<RenderWords>();
    auto& app = *program.add_subcommand("render", "Draw the frames of a run: a PNG each, and a movie; frames are "
                                                  "shared out over ranks.");
    app.add_option("folder", words->folder, "Folder of a run")->required()->type_name("DIR");
    app.add_option("--field", words->field,
           "What colours the liquid: speed (default), pressure, density, ...; none: with --style surface, its own "
           "colour")
        ->type_name("NAME");
    app.add_option("--colour-map,--color-map", words->map, "viridis (default) or diverging")
        ->check(CLI::IsMember({"viridis", "diverging"}))
        ->type_name("MAP");
    app.add_option("--range", words->range, "Values of the ends of the colours (default: from all frames)")
        ->type_name("LOW:HIGH");
    app.add_option(
           "--camera", words->camera, "A camera of the scene, automatic, or a camera file (default: the first one)")
        ->type_name("NAME|FILE");
    app.add_option("--style", words->style,
           "spheres (default): every particle; surface: the closed mesh of export --to surface")
        ->check(CLI::IsMember({"spheres", "surface"}))
        ->type_name("STYLE");
    add_repeated(app, "--colour,--color", words->colours, "With --field none: a liquid's own colour, honey=#d68018.");
    app.add_option("--cut", words->cut,
           "Leave out what is on the camera's side of a plane and show the section: \"x=5 cm\", or point; normal: \"10 "
           "0 5 cm; 1 0 1\"")
        ->type_name("PLANE");
    app.add_option("--background", words->background, "white (default) or dark")
        ->check(CLI::IsMember({"white", "dark"}))
        ->type_name("COLOUR");
    app.add_option("--frames", words->frames, frames_doc)->type_name("A:B:C");
    app.add_option("--fps", words->frames_per_second, "Frames per second of the movie (default: real time, 10 to 60)")
        ->check(CLI::Range(0.1, 1000.0))
        ->type_name("NUMBER");
    app.add_option("--size", words->size, "Of the pictures in pixels (default: the camera's)")->type_name("WxH");
    auto* movie = app.add_option("--movie", words->movie, "MP4 (default: CAMERA_FIELD.mp4 beside the pictures)")
                      ->type_name("FILE");
    app.add_flag("--no-movie", words->no_movie, "Pictures only")->excludes(movie);
    app.add_option("--out", words->out, "Folder (default: pictures/ in that of the run)")->type_name("DIR");
    app.callback([words, &chosen] {
        chosen.make = [words]() -> Command {
            return [request = render_request(*words)](const Comm& comm) { return render_run(comm, request); };
        };
    });
}

} // namespace treacle::app
