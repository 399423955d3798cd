#include "video/drawing/section.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::video {

namespace {
constexpr int block = 16; // pixels along the edge of the squares that are classified at once

// The plane's points in the scene's axes.
class Section {
public:
    Section(const Camera& camera, const CutPlane& cut)
        : camera_(camera), normal_(camera.direction_to_camera(cut.normal)),
          offset_(dot(normal_, camera.to_camera(cut.point))) {}

    // Depth [m] on the ray of a pixel; not positive: none.
    double depth_at(int column, int row) const {
        const Ray ray = ray_through(camera_, float(column) + 0.5F, float(row) + 0.5F);
        const double along = dot(normal_, wide(ray.direction));
        return along == 0 ? 0 : (offset_ - dot(normal_, wide(ray.origin))) / along;
    }
    Vec3 point_at(int column, int row, double depth) const {
        const Ray ray = ray_through(camera_, float(column) + 0.5F, float(row) + 0.5F);
        return camera_.to_world(wide(ray.origin) + depth * wide(ray.direction));
    }

private:
    static Vec3 wide(const Vec3f& a) { return {a[0], a[1], a[2]}; }
    const Camera& camera_;
    Vec3 normal_;
    double offset_;
};
} // namespace

std::vector<float> draw_section(
    const Camera& camera, const CutPlane& cut, const std::function<double(const Vec3&)>& distance) {
    const Section section(camera, cut);
    const int width = camera.width(), height = camera.height();
    std::vector<float> depth(std::size_t(width) * std::size_t(height), far_away);
    for (int top = 0; top < height; top += block)
        for (int left = 0; left < width; left += block) {
            const int right = std::min(left + block, width) - 1, bottom = std::min(top + block, height) - 1;
            const int column = (left + right) / 2, row = (top + bottom) / 2;
            const double middle = section.depth_at(column, row);
            double gap = 0, radius = 1; // of the square's middle from the solid, and from its corners
            bool seen = middle > 0;
            if (seen) {
                const auto centre = section.point_at(column, row, middle);
                gap = distance(centre);
                radius = 0;
                for (const auto& [c, r] : {std::pair{left, top}, {right, top}, {left, bottom}, {right, bottom}}) {
                    const double z = section.depth_at(c, r);
                    seen = seen && z > 0;
                    radius = std::max(radius, 1.1 * length(section.point_at(c, r, z) - centre));
                }
            }
            if (seen && gap > radius) continue;
            for (int r = top; r <= bottom; ++r)
                for (int c = left; c <= right; ++c) {
                    const double z = section.depth_at(c, r);
                    if (z > 0 && (gap < -radius || distance(section.point_at(c, r, z)) < 0))
                        depth[std::size_t(r) * std::size_t(width) + std::size_t(c)] = float(z);
                }
        }
    return depth;
}

} // namespace treacle::video
