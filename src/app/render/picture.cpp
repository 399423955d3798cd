#include "app/render/picture.hpp"

#include "app/input/camera_files.hpp"
#include "app/setup/geometry.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <cstdio>

namespace treacle::app {

video::DomainBox domain_box(const scene::Domain& domain) {
    const auto whole = domain.with_images();
    return {whole.min, whole.max, whole.dimensions};
}

PictureSize read_picture_size(const std::string& text) {
    PictureSize size;
    char rest = 0;
    const int read = std::sscanf(text.c_str(), "%5dx%5d%c", &size.width, &size.height, &rest);
    const auto fits = [](int pixels) { return pixels >= 16 && pixels <= 16384; };
    if (read != 2 || !fits(size.width) || !fits(size.height)) {
        throw InputError({"--size " + text, "is no size of a picture", "both sides have 16 to 16384 pixels",
            "write for instance 1920x1080"});
    }
    return size;
}

scene::Camera find_camera(const scene::Scene& scene, const std::string& name) {
    if (name == "automatic" || (name.empty() && scene.cameras.empty())) {
        scene::Camera camera;
        camera.name = name.empty() ? camera.name : name;
        return camera;
    }
    if (name.empty()) return scene.cameras.front();
    std::vector<std::string> names;
    for (const auto& camera : scene.cameras) {
        if (camera.name == name) return camera;
        names.push_back(camera.name);
    }
    if (std::filesystem::exists(name) || name.find(':') != std::string::npos) return camera_of_file(name);
    names.emplace_back("automatic");
    const auto close = nearest(name, names);
    throw InputError({"--camera " + name,
        "the scene has no such camera" + (close ? "; did you mean " + *close + "?" : std::string()),
        "there are " + join(names, ", "), "give one of these, or a camera file"});
}

video::View view_of(const scene::Camera& camera, const scene::Domain& domain, const PictureSize& size) {
    const int width = size.width > 0 ? size.width : camera.width;
    const int height = size.height > 0 ? size.height : camera.height;
    if (camera.automatic) return video::automatic_view(domain_box(domain), width, height);
    video::View view;
    if (camera.measured) view.model = camera.model().for_size(width, height);
    view.position = camera.position;
    view.target = camera.target;
    view.up = camera.up;
    view.vertical_field_of_view = camera.field_of_view;
    view.width = width;
    view.height = height;
    return view;
}

void DrawnSolids::add(const Vec3& position, SolidKind kind) {
    auto& points = kind == SolidKind::wall ? walls : kind == SolidKind::body ? bodies : hollows;
    points.insert(points.end(), position.begin(), position.end());
}

void add_solid_layers(const DrawnSolids& points, double spacing, std::vector<video::ParticleLayer>& layers) {
    const auto add = [&](video::LayerKind kind, const char* name, const std::vector<double>& positions,
                         double opacity) {
        if (positions.empty()) return;
        auto& layer = layers.emplace_back();
        layer.kind = kind;
        layer.name = name;
        layer.positions = positions;
        layer.radius = spacing / 2;
        layer.opacity = opacity;
    };
    add(video::LayerKind::wall, "walls", points.walls, 1);
    add(video::LayerKind::body, "bodies", points.bodies, 1);
    add(video::LayerKind::body, "hollow bodies", points.hollows, 0.12);
}

} // namespace treacle::app
