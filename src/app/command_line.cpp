#include "app/command_line.hpp"

#include "app/bench/bench.hpp"
#include "app/bench/bench_pressure.hpp"
#include "app/bench/bench_viscosity.hpp"
#include "app/check/check.hpp"
#include "app/export/export_frames.hpp"
#include "app/export/export_surface.hpp"
#include "app/export/info.hpp"
#include "app/export/manual.hpp"
#include "app/input/option_values.hpp"
#include "app/render/liquid_picture.hpp"
#include "app/render/render.hpp"
#include "app/run/run.hpp"
#include "app/study/study_check.hpp"
#include "app/study_commands.hpp"
#include "app/video/calibrate.hpp"
#include "app/video_commands.hpp"
#include "base/text/text.hpp"
#include "identify/experiment/study_file.hpp"
#include "scene/materials.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>

namespace treacle::app {

namespace {

using Words = std::vector<std::string>;
using Command = std::function<ExitCode(const Comm&)>;

// What a subcommand fills in; `make` turns it into the command when all is read.
struct Chosen {
    std::string petsc;
    std::function<Command()> make;
    std::function<ExitCode()> alone; // in the place of the command, without MPI
};

Command print(const std::string& text) {
    return [text](const Comm& comm) {
        if (comm.is_root()) std::fputs(text.c_str(), stdout);
        return ExitCode::ok;
    };
}

// A scene's file, or the scene.yaml in a folder. Collective.
std::filesystem::path find_scene(const Comm& comm, const std::string& name) {
    std::filesystem::path path = name;
    comm.guard_root([&] {
        const auto in_folder = [&](const char* name) { return std::filesystem::exists(path / name); };
        if (std::filesystem::is_directory(path)) path /= in_folder("study.yaml") && !in_folder("scene.yaml") ? "study.yaml" : "scene.yaml";
        if (std::filesystem::exists(path)) return;
        throw InputError({path.string(), "there is no such file",
                          "a scene is a YAML file, or a folder with scene.yaml",
                          "`treacle schema` describes it"});
    });
    return comm.broadcast(path.string());
}

struct SourceWords {
    std::string scene;
    Words overrides, data, materials;

    InputSource source(const Comm& comm) const {
        return {find_scene(comm, scene), overrides, {data.begin(), data.end()}, {}, materials};
    }
};

// One value each time, so that what follows is not taken for another one.
void add_repeated(CLI::App& app, const std::string& name, Words& values, const std::string& doc) {
    app.add_option(name, values, doc + " May be given several times.")->allow_extra_args(false);
}

void add_source(CLI::App& app, SourceWords& words) {
    app.add_option("scene", words.scene, "YAML file, or a folder with scene.yaml")
        ->required()
        ->type_name("SCENE");
    add_repeated(app, "--set", words.overrides, "Override a key of the scene: a.b.c=value.");
    add_repeated(app, "--data", words.data, "Folder in which meshes are looked up.");
}

void add_materials(CLI::App& app, SourceWords& words) {
    add_repeated(app, "--material", words.materials,
                 "Give a liquid of the scene what `treacle identify` found, from its result.yaml: FILE; FILE:NAME where that has several "
                 "liquids; LIQUID=FILE where the scene has. What --set says counts more.");
}

void add_petsc(CLI::App& app, Chosen& chosen) {
    app.add_option("--petsc", chosen.petsc, "Options for PETSc, as in \"-pressure_pc_type sor -log_view\"")
        ->type_name("OPTIONS");
}

void add_run(CLI::App& program, Chosen& chosen, const Words& arguments) {
    struct RunWords : SourceWords {
        std::string out, wall_limit;
        bool overwrite = false;
    };
    auto words = std::make_shared<RunWords>();
    auto& app = *program.add_subcommand("run", "Run a scene; under mpirun on all its ranks.");
    add_source(app, *words);
    add_materials(app, *words);
    app.add_option("--out", words->out, "Folder for the results (default: out/NAME)")->type_name("DIR");
    app.add_flag("--overwrite", words->overwrite, "Replace the results of an earlier run in that folder");
    app.add_option("--wall-limit", words->wall_limit,
                   "Stop with a checkpoint after this time of the clock, as in 2h; exit code 5")
        ->type_name("TIME");
    add_petsc(app, chosen);
    app.callback([words, arguments, &chosen] {
        chosen.make = [words, arguments]() -> Command {
            const double limit = read_wall_limit(words->wall_limit);
            return [words, arguments, limit](const Comm& comm) {
                RunRequest request;
                request.source = words->source(comm);
                request.out = words->out;
                request.existing =
                    words->overwrite ? io::ExistingFiles::overwrite : io::ExistingFiles::refuse;
                request.wall_limit = limit;
                request.command = arguments;
                return run_scene(comm, request);
            };
        };
    });
}

void add_resume(CLI::App& program, Chosen& chosen, const Words& arguments) {
    struct ResumeWords {
        std::string folder, until, wall_limit;
        Words changes;
    };
    auto words = std::make_shared<ResumeWords>();
    auto& app =
        *program.add_subcommand("resume", "Go on from the newest valid checkpoint, on any number of ranks.");
    app.add_option("folder", words->folder, "Folder of a run")->required()->type_name("DIR");
    app.add_option("--until", words->until, "Simulated time at which the run ends from now on, in place of time.end")
        ->type_name("TIME");
    add_repeated(app, "--set", words->changes, "Change time.end, output, cameras or lost_limit of the scene: a.b.c=value.");
    app.add_option("--wall-limit", words->wall_limit, "Stop with a checkpoint after this time of the clock")
        ->type_name("TIME");
    add_petsc(app, chosen);
    app.callback([words, arguments, &chosen] {
        chosen.make = [words, arguments]() -> Command {
            ResumeRequest request{words->folder, {}, read_wall_limit(words->wall_limit), arguments};
            for (const auto& change : words->changes) request.changes.push_back({change, "--set " + change});
            if (!words->until.empty()) request.changes.push_back({"time.end=" + words->until, "--until " + words->until});
            return [request](const Comm& comm) { return resume_run(comm, request); };
        };
    });
}

void add_check(CLI::App& program, Chosen& chosen) {
    struct CheckWords : SourceWords {
        std::string picture;
    };
    auto words = std::make_shared<CheckWords>();
    auto& app =
        *program.add_subcommand("check", "Everything short of running: keys, files, meshes, overlaps, "
                                         "particles, memory, time step, dimensionless numbers; of a study its runs and their memory.");
    add_source(app, *words);
    add_materials(app, *words);
    app.add_option("--picture", words->picture, "Draw the particles at the start into this PNG")
        ->type_name("FILE");
    app.callback([words, &chosen] {
        chosen.make = [words]() -> Command {
            return [words](const Comm& comm) {
                const auto file = find_scene(comm, words->scene);
                if (is_study(file)) {
                    if (!words->materials.empty()) {
                        throw InputError({"--material", "has no effect on a study", "its scenes have liquids of their own, which it searches", "give a scene, or leave it out"});
                    }
                    comm.guard_root([&] { check_study(file, words->overrides); });
                    return ExitCode::ok;
                }
                return check_scene(comm, {words->source(comm), words->picture});
            };
        };
    });
}

void add_manuals(CLI::App& program, Chosen& chosen) {
    struct SchemaWords {
        std::string key;
        bool json = false, study = false;
    };
    auto words = std::make_shared<SchemaWords>();
    auto& app = *program.add_subcommand("schema", "The manual of the scene file.");
    auto* key =
        app.add_option("key", words->key, "One key or block, such as liquids.viscosity")->type_name("KEY");
    app.add_flag("--json", words->json, "A JSON Schema, for editors")->excludes(key);
    app.add_flag("--study", words->study, "Of the study file, in the place of the scene's");
    app.callback([words, &chosen] {
        chosen.make = [words]() -> Command {
            if (words->study) return print(words->json ? identify::study_schema() : identify::study_manual(words->key));
            return print(words->json ? schema_json() : schema_text(words->key));
        };
    });
    program.add_subcommand("materials", "Presets of liquids, with their sources.")->callback([&chosen] {
        chosen.make = [] { return print(scene::materials_table()); };
    });
}

void add_info(CLI::App& program, Chosen& chosen) {
    auto path = std::make_shared<std::string>();
    auto& app = *program.add_subcommand("info", "What a frame, a checkpoint, a run's folder or a velocity field of PIV holds.");
    app.add_option("path", *path, "A .hdf, .hdf.series or .h5 file, the folder of a run, or a file of DaVis, Insight, OpenPIV or PIVlab")
        ->required()
        ->type_name("FILE|DIR");
    app.callback([path, &chosen] {
        chosen.make = [path]() -> Command {
            return [path](const Comm& comm) { return show_info(comm, *path); };
        };
    });
}

constexpr const char* frames_doc = "first:last:stride, from 0, last included, negative from the end";

void add_export(CLI::App& program, Chosen& chosen) {
    struct ExportWords {
        std::string source, format, mesh_format, frames, out, liquid, fields, box;
        double min_volume = 0;
        bool check = false;
    };
    auto words = std::make_shared<ExportWords>();
    auto& app = *program.add_subcommand(
        "export", "Convert frames for other programs; frames are shared out over ranks.");
    app.add_option("source", words->source, "Folder of a run, or one frame")
        ->required()
        ->type_name("DIR|FRAME");
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
                   "surface: what vertices carry, such as normal,velocity,density; none (default: normal,velocity,pressure,liquid)")
        ->type_name("LIST");
    app.add_option("--box", words->box, "surface: only the part in a box, closed at its sides: \"0 0 0 cm; 10 10 5 cm\"")->type_name("CORNERS");
    app.add_flag("--check", words->check,
                 "surface: count edges and vertices at which the mesh is not closed, oriented or a manifold; exit code 3 if there are any");
    app.add_option("--frames", words->frames, frames_doc)->type_name("A:B:C");
    app.add_option("--out", words->out, "Folder (default: exports/ in that of the run, or beside the frame)")
        ->type_name("DIR");
    app.callback([words, &chosen] {
        chosen.make = [words]() -> Command {
            return [words](const Comm& comm) {
                if (words->format == "surface") {
                    return export_surface(comm, {words->source, words->mesh_format.empty() ? "ply" : words->mesh_format,
                                                 words->frames, words->out, words->min_volume, words->liquid, words->fields, words->box, words->check});
                }
                const std::pair<bool, const char*> of_surfaces[] = {{!words->mesh_format.empty(), "--format"},
                                                                    {words->min_volume > 0, "--min-volume"},
                                                                    {!words->liquid.empty(), "--liquid"},
                                                                    {!words->fields.empty(), "--fields"},
                                                                    {!words->box.empty(), "--box"},
                                                                    {words->check, "--check"}};
                for (const auto& [given, option] : of_surfaces)
                    if (given) throw InputError({option, "has no effect", "it belongs to --to surface", "write --to surface, or leave it out"});
                return export_frames(comm, {words->source, words->format, words->frames, words->out});
            };
        };
    });
}

struct RenderWords {
    std::string folder, field = "speed", map = "viridis", range, camera, style = "spheres",
                        background = "white";
    std::string frames, size, movie, out, cut;
    Words colours;
    double frames_per_second = 0;
    bool no_movie = false;
};

RenderRequest render_request(const RenderWords& words) {
    RenderRequest request;
    request.folder = words.folder;
    request.field = words.field;
    request.map = words.map == "viridis" ? video::ColourMap::viridis : video::ColourMap::diverging;
    if (!words.range.empty()) request.range = read_value_range(words.range);
    request.camera = words.camera;
    request.style = words.style == "spheres" ? Style::spheres : Style::surface;
    if (!words.cut.empty()) request.cut = read_cut(words.cut);
    if (request.field == no_field && request.style == Style::spheres)
        throw InputError({"--field none", "leaves balls without a colour", "liquids have colours of their own with --style surface only", "add it, or name a field"});
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

void add_render(CLI::App& program, Chosen& chosen) {
    auto words = std::make_shared<RenderWords>();
    auto& app =
        *program.add_subcommand("render", "Draw the frames of a run: a PNG each, and a movie; frames are "
                                          "shared out over ranks.");
    app.add_option("folder", words->folder, "Folder of a run")->required()->type_name("DIR");
    app.add_option("--field", words->field,
                   "What colours the liquid: speed (default), pressure, density, ...; none: with --style surface, its own colour")
        ->type_name("NAME");
    app.add_option("--colour-map,--color-map", words->map, "viridis (default) or diverging")
        ->check(CLI::IsMember({"viridis", "diverging"}))
        ->type_name("MAP");
    app.add_option("--range", words->range, "Values of the ends of the colours (default: from all frames)")
        ->type_name("LOW:HIGH");
    app.add_option("--camera", words->camera, "A camera of the scene, automatic, or a camera file (default: the first one)")
        ->type_name("NAME|FILE");
    app.add_option("--style", words->style, "spheres (default): every particle; surface: the closed mesh of export --to surface")
        ->check(CLI::IsMember({"spheres", "surface"}))
        ->type_name("STYLE");
    add_repeated(app, "--colour,--color", words->colours, "With --field none: a liquid's own colour, honey=#d68018.");
    app.add_option("--cut", words->cut,
                   "Leave out what is on the camera's side of a plane and show the section: \"x=5 cm\", or point; normal: \"10 0 5 cm; 1 0 1\"")
        ->type_name("PLANE");
    app.add_option("--background", words->background, "white (default) or dark")
        ->check(CLI::IsMember({"white", "dark"}))
        ->type_name("COLOUR");
    app.add_option("--frames", words->frames, frames_doc)->type_name("A:B:C");
    app.add_option("--fps", words->frames_per_second,
                   "Frames per second of the movie (default: real time, 10 to 60)")
        ->check(CLI::Range(0.1, 1000.0))
        ->type_name("NUMBER");
    app.add_option("--size", words->size, "Of the pictures in pixels (default: the camera's)")
        ->type_name("WxH");
    auto* movie =
        app.add_option("--movie", words->movie, "MP4 (default: CAMERA_FIELD.mp4 beside the pictures)")
            ->type_name("FILE");
    app.add_flag("--no-movie", words->no_movie, "Pictures only")->excludes(movie);
    app.add_option("--out", words->out, "Folder (default: pictures/ in that of the run)")->type_name("DIR");
    app.callback([words, &chosen] {
        chosen.make = [words]() -> Command {
            return [request = render_request(*words)](const Comm& comm) { return render_run(comm, request); };
        };
    });
}

void add_bench(CLI::App& program, Chosen& chosen) {
    struct BenchWords {
        std::string kind, scene;
        BenchRequest request;
        PressureBenchRequest pressure;
        ViscosityBenchRequest viscosity;
    };
    auto words = std::make_shared<BenchWords>();
    auto& app = *program.add_subcommand("bench", "What a step costs on this machine, under mpirun on all ranks.");
    app.add_option("kind", words->kind,
                   "kernels: each phase against a product with the pressure matrix; strong or weak: the same, for "
                   "comparing numbers of ranks, with JSON in the last line; pressure: iterations and work of the "
                   "pressure solve by preconditioner and residual; viscosity: of the viscous solve of method: grid")
        ->required()
        ->check(CLI::IsMember({"kernels", "strong", "weak", "pressure", "viscosity"}))
        ->type_name("KIND");
    auto* particles = app.add_option("--particles", words->request.particles,
                                     "About; of a dam break (default 300000); weak: per rank");
    particles->check(CLI::Range(std::int64_t{1000}, std::int64_t{4'000'000'000}))->type_name("NUMBER");
    app.add_option("--steps", words->request.steps, "Measured steps (default 8)")
        ->check(CLI::Range(1, 100000))
        ->type_name("NUMBER");
    app.add_option("--scene", words->scene, "A scene of your own in place of the dam break")
        ->excludes(particles)
        ->type_name("SCENE");
    add_repeated(app, "--preconditioner", words->pressure.preconditioners,
                 "One or several; pressure: default multilevel, multilevel_grids, jacobi; viscosity: multilevel, boomeramg.");
    app.add_option("--residual", words->pressure.residuals,
                   "Relative; pressure: one or several, default 1e-3 1e-4 1e-6; viscosity: the first, default 1e-8")
        ->check(CLI::Range(1e-14, 1.0))
        ->type_name("NUMBER");
    app.add_option("--sweeps", words->pressure.sweeps,
                   "pressure: also the preconditioner by itself, x += M r, that many times")
        ->check(CLI::Range(1, 10000))
        ->type_name("NUMBER");
    app.add_option("--cells", words->viscosity.cells, "viscosity: along each side of the cube, one or several; default 96")
        ->check(CLI::Range(8, 1000))
        ->type_name("NUMBER");
    app.add_option("--repeats", words->viscosity.repeats, "viscosity: solves of each case, whose median counts; default 1")
        ->check(CLI::Range(1, 1000))
        ->type_name("NUMBER");
    app.add_option("--stiffness", words->viscosity.stiffness,
                   "viscosity: nu dt/dx2, one or several, in place of 1e3 and 1e5 Pa s with dt 0.01 s")
        ->check(CLI::PositiveNumber)
        ->type_name("NUMBER");
    add_repeated(app, "--set", words->request.overrides, "Override a key of the scene: a.b.c=value.");
    app.add_option("--json", words->request.json, "Write the figures into this file")->type_name("FILE");
    add_petsc(app, chosen);
    app.callback([words, &chosen] {
        chosen.make = [words]() -> Command {
            return [words](const Comm& comm) {
                auto request = words->request;
                if (words->kind == "pressure") {
                    auto pressure = words->pressure;
                    pressure.particles = request.particles;
                    pressure.overrides = request.overrides;
                    pressure.json = request.json;
                    return run_pressure_bench(comm, pressure);
                }
                if (words->kind == "viscosity") {
                    auto viscosity = words->viscosity;
                    viscosity.preconditioners = words->pressure.preconditioners;
                    if (!words->pressure.residuals.empty()) viscosity.residual = words->pressure.residuals.front();
                    viscosity.json = request.json;
                    return run_viscosity_bench(comm, viscosity);
                }
                request.kind = words->kind == "weak"     ? BenchKind::weak
                               : words->kind == "strong" ? BenchKind::strong
                                                         : BenchKind::kernels;
                if (!words->scene.empty()) request.scene = find_scene(comm, words->scene);
                return run_bench(comm, request);
            };
        };
    });
}

void add_lens_options(CLI::App& app, CalibrateRequest& request) {
    app.add_option("pictures", request.pictures, "Pictures of the board, folders with them, or videos of it")->type_name("PICTURE...");
    app.add_option("--camera", request.camera, "A lens that is known, in the place of pictures: OpenCV's YAML, JSON or XML, "
                                               "ViRheometry's camera_params.xml, COLMAP's text model; FILE:NAME for one of several")
        ->type_name("FILE");
    app.add_option("--board", request.board,
                   "9x6 (default): a chessboard by its inner corners; circles:4x11: an asymmetric grid of circles")
        ->type_name("SIZE");
    app.add_option("--square", request.square, "Side of a square, or distance of neighbouring rows of circles, as in 25mm")
        ->type_name("LENGTH");
    app.add_option("--coefficients", request.coefficients,
                   "Of the distortion: 0, 4 (k1 k2 p1 p2), 5 (and k3, default) or 8 (and k4 k5 k6)")
        ->check(CLI::IsMember({0, 4, 5, 8}))
        ->type_name("NUMBER");
    app.add_option("--window", request.window,
                   "Half of the side of the window in which corners are refined (default: 0.4 of the smallest square, 2 to 11)")
        ->check(CLI::Range(1, 100))
        ->type_name("PIXELS");
    app.add_option("--outliers", request.outliers, "A picture is left out when its error exceeds the median by this factor (default 3)")
        ->check(CLI::Range(1.0, 1e9))
        ->type_name("FACTOR");
    app.add_option("--name", request.name, "Of the camera (default main)")->type_name("NAME");
    app.add_option("--out", request.out, "The camera's file: .yaml (default camera.yaml), .json or .xml")->type_name("FILE");
}

void add_pose_options(CLI::App& app, CalibrateRequest& request) {
    const auto add = [&](const std::string& name, std::string& text, const std::string& doc, const std::string& type) {
        app.add_option(name, text, doc)->type_name(type);
    };
    add("--points", request.points, "Pose from points of the scene: a table with columns x [cm], y [cm], z [cm], u, v and perhaps s", "FILE");
    app.add_option("--point-noise", request.point_noise, "Standard deviation of u and v where the table states none (default 1)")
        ->check(CLI::PositiveNumber)
        ->type_name("PIXELS");
    add("--pose-picture", request.pose_picture, "Pose from a picture of the board where it lies in the scene", "PICTURE");
    add("--board-in-scene", request.board_in_scene,
        "Where that is: first point; axis along a row; axis along a column; thickness of the board, as in \"10 0 5 cm; 1 0 0; 0 0 1; 2 mm\"", "PLACE");
    add("--scene", request.scene, "The scene that the camera films", "SCENE");
    add_repeated(app, "--set", request.overrides, "Override a key of the scene: a.b.c=value.");
    add_repeated(app, "--data", request.data, "Folder in which meshes are looked up.");
    add("--contour", request.contour, "Refine the pose on the silhouette of the first frame: a mask", "PICTURE");
    add("--contour-of", request.contour_of, "Which liquid or body of the scene the mask shows (default: the liquids)", "NAME");
    add("--level", request.level, "The vertical from where the liquid's level meets walls: lines \"u, v, x = 2 cm\"", "FILE");
    add("--plumb", request.plumb, "The vertical from a plumb line: lines as those of --level", "FILE");
    add("--overlay", request.overlay, "Draw the scene at its start over --frame into this PNG", "FILE");
    add("--frame", request.frame, "A frame of the video, for --overlay", "PICTURE");
}

void add_calibrate(CLI::App& program, Chosen& chosen) {
    auto request = std::make_shared<CalibrateRequest>();
    auto& app = *program.add_subcommand("calibrate", "The lens of a camera from pictures of a board, and its pose in a scene.");
    add_lens_options(app, *request);
    add_pose_options(app, *request);
    app.callback([request, &chosen] {
        chosen.make = [request]() -> Command {
            return [request](const Comm& comm) { return calibrate_camera(comm, *request); };
        };
    });
}

void add_commands(CLI::App& program, Chosen& chosen, const Words& arguments) {
    add_run(program, chosen, arguments);
    add_resume(program, chosen, arguments);
    add_check(program, chosen);
    add_manuals(program, chosen);
    add_info(program, chosen);
    add_export(program, chosen);
    add_render(program, chosen);
    add_study_commands(program, {[&chosen](std::function<Command()> make) { chosen.make = std::move(make); },
                                 [&chosen](std::function<ExitCode()> alone) { chosen.alone = std::move(alone); }});
    add_video_commands(program, [&chosen](std::function<Command()> make) { chosen.make = std::move(make); });
    add_calibrate(program, chosen);
    add_bench(program, chosen);
}

constexpr const char* exit_codes = R"(
Exit codes: 0 ok, 2 bad input, 3 the simulation failed, 4 out of memory, 5 stopped with a checkpoint.
`treacle COMMAND --help` shows the options of a command, `treacle schema` the keys of a scene.)";

// A value that starts with '-' would be taken for an option unless it is joined to its own.
Words join_values(const Words& arguments) {
    Words out;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const auto& word = arguments[i];
        const bool takes = word == "--petsc" || word == "--frames" || word == "--range";
        if (takes && i + 1 < arguments.size()) {
            out.push_back(word + "=" + arguments[++i]);
        } else {
            out.push_back(word);
        }
    }
    return out;
}

Words command_names(const CLI::App& program) {
    Words names;
    for (const auto* app : program.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(app->get_name());
    return names;
}

Words option_names(const CLI::App& app) {
    Words names;
    for (const auto* option : app.get_options()) {
        for (const auto& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

std::string suggestion(const std::string& word, const Words& known) {
    const auto close = nearest(word, known);
    return close ? "did you mean " + *close + "?" : "";
}

InputError unknown_command(const std::string& word, const Words& known) {
    const auto close = suggestion(word, known);
    return InputError({"treacle", word + " is no command" + (close.empty() ? "" : "; " + close),
                       "there are " + join(known, ", "), "`treacle --help` describes them"});
}

InputError explain(const CLI::App& app, const CLI::ParseError& error) {
    const std::string where = "treacle " + app.get_name();
    const std::string cure = "`" + where + " --help` shows what it takes";
    const auto extras = app.remaining(true);
    if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr || extras.empty()) {
        return InputError({where, error.what(), "", cure});
    }
    const auto word = extras.front().substr(0, extras.front().find('='));
    if (word.front() != '-') return InputError({where, "too many arguments: " + word, "", cure});
    const auto close = suggestion(word, option_names(app));
    return InputError({where, word + " is no option of it" + (close.empty() ? "" : "; " + close), "", cure});
}

} // namespace

CommandLine read_command_line(const Words& arguments) {
    Chosen chosen;
    CLI::App program("Viscous liquids with free surfaces and solid bodies.", "treacle");
    program.footer(exit_codes);
    program.require_subcommand(0, 1);
    program.set_help_flag("-h,--help", "This text");
    bool version = false;
    program.add_flag("--version", version, "Version of the program, its sources, compiler and libraries");
    add_commands(program, chosen, arguments);
    if (arguments.size() < 2) return {"", print(program.help()), {}};
    auto words = join_values({arguments.begin() + 1, arguments.end()});
    const auto known = command_names(program);
    if (words.front().front() != '-' && std::ranges::find(known, words.front()) == known.end()) {
        throw unknown_command(words.front(), known);
    }
    std::ranges::reverse(words);
    const auto used = [&]() -> const CLI::App& {
        const auto parsed = program.get_subcommands();
        return parsed.empty() ? program : *parsed.front();
    };
    try {
        program.parse(std::move(words));
    } catch (const CLI::CallForHelp&) {
        return {"", print(used().help(&used() == &program ? "" : std::string("treacle"))), {}};
    } catch (const CLI::ParseError& error) {
        throw explain(used(), error);
    }
    if (version) return {"", [](const Comm& comm) { return print(version_text())(comm); }, {}};
    if (!chosen.make) return {"", print(program.help()), {}};
    return {chosen.petsc, chosen.make(), chosen.alone};
}

bool may_go_alone(const Words& arguments) {
    constexpr std::array names{"new", "sweep", "identify", "next", "study"};
    return arguments.size() > 1 && std::ranges::find(names, arguments[1]) != names.end();
}

} // namespace treacle::app
