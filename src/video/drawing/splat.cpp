#include "video/drawing/splat.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::video {

namespace {
// The tangents to a circle of radius r about (c, z) seen from the origin, as slopes.
std::pair<float, float> tangent_slopes(float c, float z, float r) {
    const float zz = z * z - r * r;
    const float root = r * std::sqrt(std::max(c * c + zz, 0.0f));
    return {(c * z - root) / zz, (c * z + root) / zz};
}

// Through a distorted lens: of points along the rim of the rectangle of slopes, and a little more, as it bulges between
// them.
PixelBox pixels_through_lens(const Camera& camera, const std::pair<float, float>& x, const std::pair<float, float>& y) {
    constexpr int points = 3; // along each side
    double left = HUGE_VAL, right = -HUGE_VAL, top = HUGE_VAL, bottom = -HUGE_VAL;
    for (int i = 0; i < points; ++i)
        for (int j = 0; j < points; ++j) {
            const auto at = [](const std::pair<float, float>& range, int k) {
                return range.first + (range.second - range.first) * k / (points - 1);
            };
            if (i == 1 && j == 1) continue;
            const auto p = camera.project_camera({at(x, i), at(y, j), 1});
            left = std::min(left, p.x);
            right = std::max(right, p.x);
            top = std::min(top, p.y);
            bottom = std::max(bottom, p.y);
        }
    const double more = 1 + 0.1 * std::max(right - left, bottom - top);
    const auto clamped = [](double v, int side) { return int(std::clamp(v, 0.0, double(side))); };
    return {clamped(std::floor(left - more), camera.width()), clamped(std::ceil(right + more), camera.width()),
        clamped(std::floor(top - more), camera.height()), clamped(std::ceil(bottom + more), camera.height())};
}

} // namespace

PixelBox pixels_of(const Camera& camera, const Sphere& s) {
    const auto& [c, r] = s;
    std::pair<float, float> x{c[0] - r, c[0] + r}, y{c[1] - r, c[1] + r};
    if (camera.is_perspective()) {
        if (c[2] <= 1.001f * r) return {0, 0, 0, 0};
        x = tangent_slopes(c[0], c[2], r);
        y = tangent_slopes(c[1], c[2], r);
        if (camera.lens()) return pixels_through_lens(camera, x, y);
    } else if (c[2] <= r) {
        return {0, 0, 0, 0};
    }
    const float scale = float(camera.scale());
    const float half_width = 0.5f * camera.width(), half_height = 0.5f * camera.height();
    // Clamped before the conversion: a sphere far outside has pixel numbers beyond an int.
    const auto first = [scale](float v, float half) {
        return int(std::clamp(std::floor(half + scale * v), 0.0f, 2 * half));
    };
    const auto last = [scale](
                          float v, float half) { return int(std::clamp(std::ceil(half + scale * v), 0.0f, 2 * half)); };
    return {first(x.first, half_width), last(x.second, half_width), first(y.first, half_height),
        last(y.second, half_height)};
}

namespace {
// The loop below meets each pixel of a sphere's box with: discriminant (of the ray meeting the ball), the
// middle of the two meetings times `dd`, and `dd`, the squared length of the ray's direction.
// |d x c|^2 is written with d - c/c_z: the usual form cancels all digits of a small, distant ball.
template <class Visit>
void visit_lens_row(const LensRays& lens, int width, const Sphere& s, const PixelBox& box, int row, Visit visit) {
    const auto& [c, r] = s;
    const float* slopes_x = lens.x.data() + std::size_t(row) * width;
    const float* slopes_y = lens.y.data() + std::size_t(row) * width;
    const float sx = c[0] / c[2], sy = c[1] / c[2], rr = r * r, zz = c[2] * c[2];
#pragma GCC ivdep
    for (int i = box.left; i < box.right; ++i) {
        const float dx = slopes_x[i], dy = slopes_y[i], wx = dx - sx, wy = dy - sy;
        const float dd = dx * dx + dy * dy + 1;
        const float twist = wx * c[1] - wy * c[0];
        visit(i, rr * dd - zz * (wx * wx + wy * wy) - twist * twist, dx * c[0] + dy * c[1] + c[2], dd);
    }
}

template <class Visit>
void visit_row(const Camera& camera, const Sphere& s, const PixelBox& box, int row, Visit visit) {
    if (camera.lens()) return visit_lens_row(*camera.lens(), camera.width(), s, box, row, visit);
    const auto& [c, r] = s;
    const float step = float(1 / camera.scale());
    const float x0 = (0.5f - 0.5f * camera.width()) * step;
    const float dy = (row + 0.5f - 0.5f * camera.height()) * step;
    if (camera.is_perspective()) {
        const float sx = c[0] / c[2], wy = dy - c[1] / c[2];
        const float rr = r * r, zz = c[2] * c[2];
#pragma GCC ivdep
        for (int i = box.left; i < box.right; ++i) {
            const float dx = x0 + i * step, wx = dx - sx;
            const float dd = dx * dx + dy * dy + 1;
            const float twist = wx * c[1] - wy * c[0];
            visit(i, rr * dd - zz * (wx * wx + wy * wy) - twist * twist, dx * c[0] + dy * c[1] + c[2], dd);
        }
    } else {
        const float wy = dy - c[1], rr = r * r - wy * wy;
#pragma GCC ivdep
        for (int i = box.left; i < box.right; ++i) {
            const float wx = x0 + i * step - c[0];
            visit(i, rr - wx * wx, c[2], 1.0f);
        }
    }
}
} // namespace

DepthBuffer::DepthBuffer(int w, int h)
    : width(w), height(h), depth(std::size_t(w) * h, far_away), sphere(std::size_t(w) * h, no_sphere) {}

Ray ray_through(const Camera& camera, float x, float y) {
    if (const auto* lens = camera.lens()) {
        const int column = std::clamp(int(x), 0, camera.width() - 1), row = std::clamp(int(y), 0, camera.height() - 1);
        const std::size_t i = std::size_t(row) * camera.width() + column;
        return {{0, 0, 0}, {lens->x[i], lens->y[i], 1}};
    }
    const float dx = float((x - 0.5 * camera.width()) / camera.scale());
    const float dy = float((y - 0.5 * camera.height()) / camera.scale());
    if (camera.is_perspective()) return {{0, 0, 0}, {dx, dy, 1}};
    return {{dx, dy, 0}, {0, 0, 1}};
}

void splat(const Camera& camera, std::span<const Sphere> spheres, DepthBuffer& buffer) {
    for (std::size_t k = 0; k < spheres.size(); ++k) {
        const PixelBox box = pixels_of(camera, spheres[k]);
        if (box.is_empty()) continue;
        for (int row = box.top; row < box.bottom; ++row) {
            float* depth = buffer.depth.data() + std::size_t(row) * buffer.width;
            std::int32_t* sphere = buffer.sphere.data() + std::size_t(row) * buffer.width;
            visit_row(camera, spheres[k], box, row, [=](int i, float discriminant, float middle, float dd) {
                const float t = (middle - std::sqrt(std::max(discriminant, 0.0f))) / dd;
                const bool wins = (discriminant >= 0) & (t < depth[i]);
                depth[i] = wins ? t : depth[i];
                sphere[i] = wins ? std::int32_t(k) : sphere[i];
            });
        }
    }
}

} // namespace treacle::video
