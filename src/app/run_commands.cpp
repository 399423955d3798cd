#include "app/subcommands.hpp"

#include "app/check/check.hpp"
#include "app/export/info.hpp"
#include "app/export/manual.hpp"
#include "app/input/option_values.hpp"
#include "app/run/run.hpp"
#include "app/study/study_check.hpp"
#include "base/text/text.hpp"
#include "identify/experiment/study_file.hpp"
#include "scene/materials.hpp"

#include <memory>

namespace treacle::app {

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
                request.existing = words->overwrite ? io::ExistingFiles::overwrite : io::ExistingFiles::refuse;
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
    auto& app = *program.add_subcommand("resume", "Go on from the newest valid checkpoint, on any number of ranks.");
    app.add_option("folder", words->folder, "Folder of a run")->required()->type_name("DIR");
    app.add_option("--until", words->until, "Simulated time at which the run ends from now on, in place of time.end")
        ->type_name("TIME");
    add_repeated(app, "--set", words->changes,
        "Change time.end, output, cameras or max_lost_fraction of the scene: a.b.c=value.");
    app.add_option("--wall-limit", words->wall_limit, "Stop with a checkpoint after this time of the clock")
        ->type_name("TIME");
    add_petsc(app, chosen);
    app.callback([words, arguments, &chosen] {
        chosen.make = [words, arguments]() -> Command {
            ResumeRequest request{words->folder, {}, read_wall_limit(words->wall_limit), arguments};
            for (const auto& change : words->changes) request.changes.push_back({change, "--set " + change});
            if (!words->until.empty())
                request.changes.push_back({"time.end=" + words->until, "--until " + words->until});
            return [request](const Comm& comm) { return resume_run(comm, request); };
        };
    });
}

void add_check(CLI::App& program, Chosen& chosen) {
    struct CheckWords : SourceWords {
        std::string picture;
    };
    auto words = std::make_shared<CheckWords>();
    auto& app = *program.add_subcommand("check",
        "Everything short of running: keys, files, meshes, overlaps, "
        "particles, memory, time step, dimensionless numbers; of a study its runs and their memory.");
    add_source(app, *words);
    add_materials(app, *words);
    app.add_option("--picture", words->picture, "Draw the particles at the start into this PNG")->type_name("FILE");
    app.callback([words, &chosen] {
        chosen.make = [words]() -> Command {
            return [words](const Comm& comm) {
                const auto file = find_scene(comm, words->scene);
                if (is_study(file)) {
                    if (!words->materials.empty()) {
                        throw InputError({"--material", "has no effect on a study",
                            "its scenes have liquids of their own, which it searches",
                            "give a scene, or leave it out"});
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
    auto* key = app.add_option("key", words->key, "One key or block, such as liquids.viscosity")->type_name("KEY");
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
    auto& app =
        *program.add_subcommand("info", "What a frame, a checkpoint, a run's folder or a velocity field of PIV holds.");
    app.add_option("path", *path,
           "A .hdf, .hdf.series or .h5 file, the folder of a run, or a file of DaVis, Insight, OpenPIV or PIVlab")
        ->required()
        ->type_name("FILE|DIR");
    app.callback([path, &chosen] {
        chosen.make = [path]() -> Command { return [path](const Comm& comm) { return show_info(comm, *path); }; };
    });
}

} // namespace treacle::app
