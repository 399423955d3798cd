#pragma once
#include "scene/camera/camera_model.hpp"
#include "scene/sampling/signed_distance.hpp"
#include "video/mask/contour.hpp"

#include <functional>
#include <string>
#include <vector>

namespace treacle::video {

// Part of a scene for a picture: a signed distance [m], negative inside, never larger than the true one, and a
// ball that holds all of it.
struct SeenSolid {
    std::string name;
    std::function<double(const Vec3&)> distance;
    Vec3 centre{0, 0, 0}; // [m] of the ball
    double radius = 0;    // [m]
};

// Passage of a ray by a solid: sphere tracing (Hart 1996).
struct Passing {
    bool hits = false;
    double at = 0;    // [m] along the ray: of the hit, or of the closest approach
    double least = 0; // [m] the smallest distance; 0 for a hit
};
Passing pass(const SeenSolid& solid, const Vec3& origin, const Vec3& direction);

// The ray through a pixel: origin and unit direction in the scene's axes.
struct SceneRay {
    Vec3 origin, direction; // [m]; unit
};
SceneRay ray_of(const scene::CameraModel& camera, const scene::Vec2& pixel);

// A picture of solids without light: the nearest one at each pixel's centre, by its number, -1 for none, and its distance
// [m] along the ray.
struct SolidPicture {
    int width = 0, height = 0;
    std::vector<int> number;  // [height][width]
    std::vector<float> depth; // [height][width]
    Mask mask() const;        // of all of them
};
SolidPicture look_at(const scene::CameraModel& camera, const std::vector<SeenSolid>& solids);

} // namespace treacle::video
