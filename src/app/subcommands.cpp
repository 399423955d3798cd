#include "app/subcommands.hpp"

#include <cstdio>

namespace treacle::app {

Command print(const std::string& text) {
    return [text](const Comm& comm) {
        if (comm.is_root()) std::fputs(text.c_str(), stdout);
        return ExitCode::ok;
    };
}

std::filesystem::path find_scene(const Comm& comm, const std::string& name) {
    std::filesystem::path path = name;
    comm.guard_root([&] {
        const auto in_folder = [&](const char* name) { return std::filesystem::exists(path / name); };
        if (std::filesystem::is_directory(path))
            path /= in_folder("study.yaml") && !in_folder("scene.yaml") ? "study.yaml" : "scene.yaml";
        if (std::filesystem::exists(path)) return;
        throw InputError({path.string(), "there is no such file", "a scene is a YAML file, or a folder with scene.yaml",
            "`treacle schema` describes it"});
    });
    return comm.broadcast(path.string());
}

InputSource SourceWords::source(const Comm& comm) const {
    return {find_scene(comm, scene), overrides, {data.begin(), data.end()}, {}, materials};
}

void add_repeated(CLI::App& app, const std::string& name, Words& values, const std::string& doc) {
    app.add_option(name, values, doc + " May be given several times.")->allow_extra_args(false);
}

void add_source(CLI::App& app, SourceWords& words) {
    app.add_option("scene", words.scene, "YAML file, or a folder with scene.yaml")->required()->type_name("SCENE");
    add_repeated(app, "--set", words.overrides, "Override a key of the scene: a.b.c=value.");
    add_repeated(app, "--data", words.data, "Folder in which meshes are looked up.");
}

void add_materials(CLI::App& app, SourceWords& words) {
    add_repeated(app, "--material", words.materials,
        "Give a liquid of the scene what `treacle identify` found, from its result.yaml: FILE; FILE:NAME where that "
        "has several "
        "liquids; LIQUID=FILE where the scene has. What --set says counts more.");
}

void add_petsc(CLI::App& app, Chosen& chosen) {
    app.add_option("--petsc", chosen.petsc, "Options for PETSc, as in \"-pressure_pc_type sor -log_view\"")
        ->type_name("OPTIONS");
}

} // namespace treacle::app
