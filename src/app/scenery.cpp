#include "app/scenery.hpp"

#include "app/picture.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {
// From the camera to the farthest corner of the domain [m].
double farthest(const scene::Domain& domain, const Vec3& place) {
    double far = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double square = 0;
        for (std::size_t k = 0; k < 3; ++k) square += std::pow((corner >> k & 1 ? domain.max[k] : domain.min[k]) - place[k], 2);
        far = std::max(far, std::sqrt(square));
    }
    return far;
}
} // namespace

scene::CameraModel camera_model(const scene::Camera& camera, const scene::Domain& domain) {
    const auto view = view_of(camera, domain, {});
    if (view.model) return *view.model;
    const video::Camera seen(view);
    scene::Lens lens;
    lens.width = view.width;
    lens.height = view.height;
    lens.cx = (view.width - 1) / 2.0;
    lens.cy = (view.height - 1) / 2.0;
    scene::CameraPose pose;
    for (std::size_t k = 0; k < 3; ++k) {
        Vec3 axis{0, 0, 0};
        axis[k] = 1;
        const auto column = seen.direction_to_camera(axis);
        for (std::size_t row = 0; row < 3; ++row) pose.rotation[row][k] = column[row];
    }
    pose.translation = seen.to_camera({0, 0, 0});
    lens.fx = lens.fy = seen.scale();
    if (!seen.is_perspective()) {
        // On the plane z = 0 a pinhole at depth D with f = D times the pixels per metre draws the same picture.
        lens.fx = lens.fy = seen.scale() * pose.translation[2];
    }
    return {camera.name, lens, pose};
}

video::FilmScenery draw_scenery(const Input& input, const surface::Solids& solids, const scene::CameraModel& camera) {
    if (input.scene.domain.dimensions != 3) return {};
    const double far = farthest(input.scene.domain, camera.pose().position());
    const auto& bodies = input.scene.bodies;
    const auto distance = [&](const Vec3& x) {
        double least = far;
        for (std::size_t b = 0; b < solids.bodies.size(); ++b) {
            if (b < bodies.size() && !bodies[b].shape.inverted) least = std::min(least, solids.bodies[b].distance(x));
        }
        return least;
    };
    return video::draw_solids(camera, distance, far);
}

} // namespace treacle::app
