#include "app/input/input.hpp"

#include "app/input/camera_files.hpp"
#include "base/options/options.hpp"
#include "scene/data_files.hpp"
#include "scene/renamed_keys.hpp"

namespace treacle::app {

namespace {
// Spacings that the fastest liquid moves in a step, unless the scene states it.
constexpr double usual_sph_cfl = 0.2, usual_grid_cfl = 3;
} // namespace

void Input::declare(Declaration& d) {
    scene.declare(d);
    d.block("method", method, "What moves the liquid: particles alone, or particles and a grid.", "kind");
    if (d.parsing() && scene.time.cfl == 0) scene.time.cfl = on_grid() ? usual_grid_cfl : usual_sph_cfl;
}

void MethodOptions::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.choice<MethodKind>("kind", kind, {{"sph", MethodKind::sph}, {"grid", MethodKind::grid}},
        "Hybrid incompressible SPH (dissertation, chapters 2 to 4), whose options follow; or particles in "
        "a MAC grid (chapter 5), whose options stand in the block grid.");
    SphOptions::declare(d);
    d.block("grid", grid, "Options of kind: grid.");
}

namespace {
Input read(Document document, const InputSource& source) {
    for (const auto& assignment : source.overrides) document.set(assignment);
    for (const auto& change : source.changes) document.set(change.assignment, change.origin);
    Input input;
    parse(document, input);
    input.notes = document.notes();
    return input;
}
} // namespace

Input load_input(const InputSource& source) {
    auto document = Document::load(source.scene);
    document.accept(scene::renamed_keys());
    if (source.materials.empty()) return read(document, source);
    // Materials go into liquids, whose names and number the scene itself states; overrides may be of keys that come
    // with a material.
    auto transfers = find_transfers(source.materials, read(document, InputSource{}).scene, source.scene);
    for (const auto& one : transfers) put_material(one, document);
    auto input = read(document, source);
    for (const auto& one : transfers) {
        for (auto& note : doubts(one, input.scene.liquids[one.index])) input.notes.push_back(std::move(note));
    }
    input.transfers = std::move(transfers);
    return input;
}

Input load_scene(const InputSource& source) {
    auto input = load_input(source);
    const auto search_path = scene::data_search_path(source.scene, source.data_folders);
    for (auto& note : scene::resolve_data_files(input.scene, search_path)) input.notes.push_back(std::move(note));
    read_camera_files(input.scene, search_path);
    return input;
}

} // namespace treacle::app
