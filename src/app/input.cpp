#include "app/input.hpp"

#include "base/options.hpp"

#include <cstdlib>

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
    Input input;
    parse(document, input);
    return input;
}

std::vector<std::string> mesh_folders(const InputSource& source) {
    std::vector<std::string> folders;
    if (!source.scene.empty()) folders.push_back(std::filesystem::absolute(source.scene).parent_path().string());
    for (const auto& folder : source.data_folders) folders.push_back(folder.string());
    if (const char* folder = std::getenv("TREACLE_DATA")) folders.emplace_back(folder);
    return folders;
}

} // namespace treacle::app
