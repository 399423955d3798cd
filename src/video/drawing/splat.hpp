#pragma once
#include "video/drawing/view.hpp"
#include "video/picture/vector.hpp"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace treacle::video {

// A ball in camera axes (Camera::to_camera) [m].
struct Sphere {
    Vec3f centre; // camera axes [m]
    float radius; // [m]
};

constexpr float far_away = std::numeric_limits<float>::infinity();
constexpr std::int32_t no_sphere = -1;

// Nearest surface of each pixel: [height][width].
struct DepthBuffer {
    int width = 0, height = 0;
    std::vector<float> depth;         // [m] along the viewing direction, far_away where nothing is
    std::vector<std::int32_t> sphere; // index of the sphere, no_sphere where nothing is

    DepthBuffer(int width, int height);               // nothing seen: far_away, no_sphere
    std::size_t size() const { return depth.size(); } // number of pixels
};

// The ray through a point of the picture, of measured cameras through the centre of its pixel: `direction` has z = 1 in
// perspective; in an orthographic view the ray starts at `origin` and runs along z.
struct Ray {
    Vec3f origin, direction; // camera axes [m]; direction is not of unit length
};
Ray ray_through(const Camera& camera, float x, float y);

// Draws spheres exactly (each outline is the ellipse that a lens makes of a ball), nearest first; at equal
// depth the earlier sphere stays. Spheres that touch the plane of the camera are left out.
void splat(const Camera& camera, std::span<const Sphere> spheres, DepthBuffer& buffer);

// Pixels that a sphere may cover, ends excluded; empty for one that touches the plane of the camera.
struct PixelBox {
    int left, right, top, bottom;
    bool is_empty() const { return left >= right || top >= bottom; }
};
PixelBox pixels_of(const Camera& camera, const Sphere& sphere);

} // namespace treacle::video
