#include "scene/data_files.hpp"

#include "base/text/error.hpp"

#include <cstdlib>
#include <set>
#include <utility>

namespace treacle::scene {

namespace fs = std::filesystem;

std::vector<fs::path> data_search_path(const fs::path& scene_file, const std::vector<fs::path>& data_folders) {
    const auto folder = scene_file.parent_path();
    std::vector<fs::path> out{folder.empty() ? fs::path(".") : folder};
    out.insert(out.end(), data_folders.begin(), data_folders.end());
    const char* variable = std::getenv("TREACLE_DATA");
    std::string rest = variable ? variable : "";
    while (!rest.empty()) {
        const auto end = std::min(rest.find(':'), rest.size());
        if (end > 0) out.emplace_back(rest.substr(0, end));
        rest.erase(0, end + 1);
    }
    return out;
}

fs::path find_data_file(const fs::path& name, const std::vector<fs::path>& search_path) {
    std::error_code ignored;
    if (name.is_absolute()) return fs::is_regular_file(name, ignored) ? name : fs::path();
    for (const auto& folder : search_path) {
        const auto path = folder / name;
        if (fs::is_regular_file(path, ignored)) return fs::absolute(path).lexically_normal();
    }
    return {};
}

namespace {

std::string list_folders(const std::vector<fs::path>& folders) {
    std::string out;
    for (const auto& folder : folders) out += (out.empty() ? "" : ", ") + folder.string();
    return out;
}

struct Outcome {
    std::vector<std::string> replaced;
    std::vector<Diagnostic> missing;
};

void resolve(Shape& shape, const std::vector<fs::path>& search_path, Outcome& outcome) {
    for (auto& part : shape.parts) resolve(part, search_path, outcome);
    if (shape.kind != ShapeKind::mesh) return;
    const auto path = find_data_file(shape.file, search_path);
    if (!path.empty()) {
        shape.file = path.string();
        shape.fallback.clear();
    } else if (!shape.fallback.empty()) {
        outcome.replaced.push_back(shape.where + ": the mesh " + shape.file +
                                   " was not found; its fallback is used instead. Name its folder with --data or "
                                   "TREACLE_DATA to use it.");
        Shape fallback = shape.fallback.front();
        fallback.inverted = fallback.inverted != shape.inverted;
        fallback.clip = fallback.clip || shape.clip;
        fallback.nested = shape.nested;
        shape = std::move(fallback);
    } else {
        const bool absolute = fs::path(shape.file).is_absolute();
        outcome.missing.push_back({shape.where, "the mesh " + shape.file + " was not found",
            absolute ? "" : "looked in " + list_folders(search_path),
            "name its folder with --data or TREACLE_DATA, or add a fallback"});
    }
}

// Every shape of a scene, not their parts.
template <class S, class F>
void for_each_shape(S& scene, const F& look) {
    for (auto& liquid : scene.liquids) {
        for (auto& shape : liquid.shapes) look(shape);
        for (auto& part : liquid.viscosity_regions) look(part.shape);
    }
    for (auto& body : scene.bodies) look(body.shape);
}

void add_mesh_files(const Shape& shape, std::set<std::string>& files) {
    for (const auto& part : shape.parts) add_mesh_files(part, files);
    if (shape.kind == ShapeKind::mesh) files.insert(shape.file);
}

} // namespace

std::vector<std::string> mesh_files(const Scene& scene) {
    std::set<std::string> files;
    for_each_shape(scene, [&](const Shape& shape) { add_mesh_files(shape, files); });
    return {files.begin(), files.end()};
}

std::vector<std::string> resolve_data_files(Scene& scene, const std::vector<fs::path>& search_path) {
    Outcome outcome;
    for_each_shape(scene, [&](Shape& shape) { resolve(shape, search_path, outcome); });
    if (!outcome.missing.empty()) throw InputError(std::move(outcome.missing));
    return outcome.replaced;
}

} // namespace treacle::scene
