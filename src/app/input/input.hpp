#pragma once
#include "app/input/method.hpp"
#include "app/input/transfer.hpp"
#include "scene/scene.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace treacle::app {

// The whole scene file: the scene's blocks, and the options of the method.
struct Input {
    scene::Scene scene;
    MethodOptions method;
    std::vector<std::string> notes; // fallbacks taken, by load_scene(), and doubts about transferred materials
    std::vector<Transfer> transfers;
    bool on_grid() const { return method.kind == MethodKind::grid; }

    // Keys of the whole scene file: the scene's blocks and `method`.
    void declare(Declaration& d);
};

// A change of an input: "time.end=20 s", and its origin: "--until 20 s", "study.yaml:12: viscosity".
struct Change {
    std::string assignment, origin;
};

// Sources of an input, as the command line or a study gives it.
struct InputSource {
    std::filesystem::path scene;
    std::vector<std::string> overrides;              // "a.b.c=value", of --set
    std::vector<std::filesystem::path> data_folders; // of --data; TREACLE_DATA is added
    std::vector<Change> changes;                     // after the overrides
    std::vector<std::string> materials;              // of --material, before the overrides
};

// Reads and validates; throws InputError with all problems.
Input load_input(const InputSource& source);

// As load_input; finds the files of meshes as well. Their whole paths stand in the input then, so that it may be read from
// anywhere, and fallbacks in the place of what is missing, with a note. InputError for what has none. Cameras stand in it
// with the lens and pose of their files.
Input load_scene(const InputSource& source);

} // namespace treacle::app
