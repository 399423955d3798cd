#include "app/input.hpp"

#include "base/options.hpp"

#include <cstdlib>

namespace treacle::app {

void Input::declare(Declaration& d) {
    scene.declare(d);
    d.block("method", method, "Hybrid incompressible SPH (dissertation, chapter 2).");
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
