#include "app/input.hpp"

#include "app/camera_files.hpp"
#include "base/options.hpp"
#include "scene/data_files.hpp"

namespace treacle::app {

namespace {
// Spacings that the fastest liquid moves in a step, unless the scene says.
constexpr double usual_sph_cfl = 0.2, usual_grid_cfl = 3;
} // namespace

void Input::declare(Declaration& d) {
    scene.declare(d);
    d.block("method", method, "What moves the liquid: particles alone, or particles and a grid.", "kind");
    if (d.parsing() && scene.time.cfl == 0) scene.time.cfl = on_grid() ? usual_grid_cfl : usual_sph_cfl;
}

void MethodOptions::declare(Declaration& d) {
    if (d.parsing()) where = d.place();
    d.choice<MethodKind>("kind", kind, {{"sph", MethodKind::sph}, {"grid", MethodKind::grid}},
                         "Hybrid incompressible SPH (dissertation, chapters 2 to 4), whose options follow; or particles in "
                         "a MAC grid (chapter 5), whose options stand in the block grid.");
    SphOptions::declare(d);
    d.block("grid", grid, "Options of kind: grid.");
}

Input load_input(const InputSource& source) {
    auto document = Document::load(source.scene);
    for (const auto& assignment : source.overrides) document.set(assignment);
    for (const auto& change : source.changes) document.set(change.assignment, change.origin);
    Input input;
    parse(document, input);
    return input;
}

Input load_scene(const InputSource& source) {
    auto input = load_input(source);
    const auto search_path = scene::data_search_path(source.scene, source.data_folders);
    input.notes = scene::resolve_data_files(input.scene, search_path);
    read_camera_files(input.scene, search_path);
    return input;
}

} // namespace treacle::app
