#include "app/render/scenery.hpp"

#include "app/render/moving_solids.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::app {

namespace {
// From the camera to the farthest corner of the domain [m].
double farthest(const scene::Domain& domain, const Vec3& position) {
    double far = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double square = 0;
        for (std::size_t k = 0; k < 3; ++k)
            square += std::pow((corner >> k & 1 ? domain.max[k] : domain.min[k]) - position[k], 2);
        far = std::max(far, std::sqrt(square));
    }
    return far;
}
} // namespace

void require_bodies(const Input& input, const std::vector<std::string>& names, const std::string& where) {
    std::vector<std::string> known;
    for (const auto& body : input.scene.bodies) known.push_back(body.name);
    for (const auto& name : names) {
        if (std::ranges::find(known, name) != known.end()) continue;
        const auto close = nearest(name, known);
        throw InputError({where, "the scene has no body " + name + " that could be seen through",
            known.empty() ? "it has none" : "it has " + join(known, ", "),
            close ? "did you mean " + *close + "?" : ""});
    }
}

video::FilmScenery draw_scenery(const Input& input, const surface::Solids& solids, const scene::CameraModel& camera,
    const std::vector<std::string>& through) {
    if (input.scene.domain.dimensions != 3) return {};
    const double far = farthest(input.scene.domain.with_images(), camera.pose().position());
    return video::draw_solids(camera, distance_of_seen(input, solids, far, through), far);
}

} // namespace treacle::app
