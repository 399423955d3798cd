#include "app/input/camera_files.hpp"

#include "base/text/error.hpp"
#include "scene/data_files.hpp"
#include "video/camera/camera_file.hpp"

namespace treacle::app {

namespace {

void take(scene::Camera& camera, const video::CameraRecord& record) {
    const auto model = record.model();
    camera.measured.emplace();
    camera.measured->lens = model.lens();
    camera.measured->rotation = scene::rotation_vector(model.pose().rotation);
    camera.measured->translation = model.pose().translation;
    camera.width = model.lens().width;
    camera.height = model.lens().height;
    camera.automatic = false;
    camera.file.clear();
    camera.file_camera.clear();
}

void read(scene::Camera& camera, const std::vector<std::filesystem::path>& search_path) {
    auto path = scene::find_data_file(camera.file, search_path);
    // COLMAP's models are folders.
    for (const auto& folder : search_path)
        if (path.empty() && std::filesystem::is_directory(folder / camera.file)) path = folder / camera.file;
    if (path.empty())
        throw InputError({camera.where, "the camera file " + camera.file + " was not found",
            "it is looked for relative to the scene", "write it with `treacle calibrate`"});
    auto record = video::read_camera(path, camera.file_camera);
    if (camera.size_given)
        record = video::for_pictures(record, camera.width, camera.height, camera.where + ": cameras." + camera.name);
    take(camera, record);
}

} // namespace

void read_camera_files(scene::Scene& scene, const std::vector<std::filesystem::path>& search_path) {
    std::vector<Diagnostic> problems;
    for (auto& camera : scene.cameras) {
        if (camera.file.empty()) continue;
        try {
            read(camera, search_path);
        } catch (const InputError& error) {
            problems.insert(problems.end(), error.diagnostics().begin(), error.diagnostics().end());
        }
    }
    if (!problems.empty()) throw InputError(problems);
}

scene::Camera camera_of_file(const std::string& text) {
    std::filesystem::path path = text;
    std::string name;
    const auto colon = text.rfind(':');
    if (!std::filesystem::exists(path) && colon != std::string::npos) {
        path = text.substr(0, colon);
        name = text.substr(colon + 1);
    }
    const auto record = video::read_camera(path, name);
    scene::Camera camera;
    take(camera, record);
    camera.name = record.name;
    return camera;
}

} // namespace treacle::app
