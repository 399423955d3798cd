#include "video/pose/solid_view.hpp"

#include "video/picture/vector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace treacle::video {

namespace {

constexpr double touching = 1e-6; // of the radius: closer counts as a hit
constexpr int most_steps = 400;

// Pixels that the ball of a solid may cover, ends excluded.
struct PixelBox {
    int left, right, top, bottom;
};

PixelBox box_of(const scene::CameraModel& camera, const SeenSolid& solid) {
    const auto& lens = camera.lens();
    const PixelBox all{0, lens.width, 0, lens.height};
    if (camera.to_camera(solid.centre)[2] < 1.5 * solid.radius) return all;
    // Corners of the cube around the ball.
    double left = 1e30, right = -1e30, top = 1e30, bottom = -1e30;
    for (int i = 0; i < 8; ++i) {
        const Vec3 corner{
            solid.radius * ((i & 1) ? 1 : -1), solid.radius * ((i & 2) ? 1 : -1), solid.radius * ((i & 4) ? 1 : -1)};
        const auto p = camera.project_camera(camera.to_camera(solid.centre) + corner);
        if (p.depth < scene::CameraModel::near_plane) return all;
        left = std::min(left, p.x);
        right = std::max(right, p.x);
        top = std::min(top, p.y);
        bottom = std::max(bottom, p.y);
    }
    const auto clamped = [](double v, int side) { return int(std::clamp(v, 0.0, double(side))); };
    return {clamped(left - 2, lens.width), clamped(right + 3, lens.width), clamped(top - 2, lens.height),
        clamped(bottom + 3, lens.height)};
}

} // namespace

Passing pass(const SeenSolid& solid, const Vec3& origin, const Vec3& direction) {
    const Vec3 to_centre = solid.centre - origin;
    const double middle = dot(to_centre, direction);
    const double apart = dot(to_centre, to_centre) - middle * middle, square = solid.radius * solid.radius;
    Passing out;
    if (apart > square) { // misses the ball: the closest approach to its centre
        out.at = std::max(middle, 0.0);
        out.least = std::max(solid.distance(origin + out.at * direction), std::sqrt(apart) - solid.radius);
        return out;
    }
    const double half = std::sqrt(square - apart), end = middle + half, eps = touching * solid.radius;
    double t = std::max(middle - half, 0.0);
    out.least = std::numeric_limits<double>::infinity();
    for (int step = 0; step < most_steps && t <= end; ++step) {
        const double d = solid.distance(origin + t * direction);
        if (d < out.least) {
            out.least = d;
            out.at = t;
        }
        if (d < eps) return {true, t, 0};
        t += d;
    }
    return out;
}

SceneRay ray_of(const scene::CameraModel& camera, const scene::Vec2& pixel) {
    const auto slope = camera.ray(pixel);
    const auto& r = camera.pose().rotation;
    const Vec3 d = slope[0] * r[0] + slope[1] * r[1] + r[2];
    return {camera.pose().position(), normalised(d)};
}

Mask SolidPicture::mask() const {
    Mask out{width, height, std::vector<std::uint8_t>(number.size())};
    for (std::size_t i = 0; i < number.size(); ++i) out.pixels[i] = number[i] >= 0 ? mask_liquid : mask_background;
    return out;
}

SolidPicture look_at(const scene::CameraModel& camera, const std::vector<SeenSolid>& solids) {
    const auto& lens = camera.lens();
    const std::size_t n = std::size_t(lens.width) * lens.height;
    SolidPicture out{lens.width, lens.height, std::vector<int>(n, -1),
        std::vector<float>(n, std::numeric_limits<float>::infinity())};
    for (std::size_t k = 0; k < solids.size(); ++k) {
        const auto box = box_of(camera, solids[k]);
        for (int row = box.top; row < box.bottom; ++row)
            for (int column = box.left; column < box.right; ++column) {
                const auto ray = ray_of(camera, {double(column), double(row)});
                const auto passing = pass(solids[k], ray.origin, ray.direction);
                const std::size_t i = std::size_t(row) * lens.width + column;
                if (!passing.hits || !(passing.at < out.depth[i])) continue;
                out.depth[i] = float(passing.at);
                out.number[i] = int(k);
            }
    }
    return out;
}

} // namespace treacle::video
