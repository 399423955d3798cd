#include "video/drawing/scenery.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::video {

void add_floor(const Camera& camera, const DomainBox& box, DepthBuffer& buffer) {
    const double height = camera.position()[2] - box.min[2];
    if (box.dimensions != 3 || !(height > 0) || !camera.is_perspective()) return;
    for (int row = 0; row < buffer.height; ++row)
        for (int column = 0; column < buffer.width; ++column) {
            const std::size_t i = std::size_t(row) * buffer.width + column;
            if (buffer.sphere[i] != no_sphere) continue;
            const Ray ray = ray_through(camera, column + 0.5f, row + 0.5f);
            const Vec3 d = camera.direction_to_world({ray.direction[0], ray.direction[1], 1});
            if (!(d[2] < 0)) continue;
            const double t = -height / d[2];
            const Vec3 point = camera.position() + t * d;
            const bool inside =
                point[0] >= box.min[0] && point[0] <= box.max[0] && point[1] >= box.min[1] && point[1] <= box.max[1];
            if (!inside) continue;
            buffer.depth[i] = float(t);
            buffer.sphere[i] = floor_plane;
        }
}

namespace {
// An edge in camera axes.
struct Edge {
    Vec3 from, to;
};

std::vector<Edge> edges_of(const Camera& camera, const DomainBox& box) {
    std::vector<Edge> edges;
    const bool plane = box.dimensions == 2;
    const auto corner = [&](int i) {
        return camera.to_camera({(i & 1) ? box.max[0] : box.min[0], (i & 2) ? box.max[1] : box.min[1],
            plane     ? 0
            : (i & 4) ? box.max[2]
                      : box.min[2]});
    };
    for (int i = 0; i < (plane ? 4 : 8); ++i)
        for (int axis = 0; axis < box.dimensions; ++axis)
            if (!(i & (1 << axis))) edges.push_back({corner(i), corner(i | (1 << axis))});
    return edges;
}

// The part of an edge in front of the camera; false if there is none.
bool clip(Edge& edge, double nearest) {
    if (edge.from[2] < nearest && edge.to[2] < nearest) return false;
    const auto move = [nearest](Vec3& behind, const Vec3& other) {
        if (behind[2] < nearest) behind = behind + ((nearest - behind[2]) / (other[2] - behind[2])) * (other - behind);
    };
    move(edge.from, edge.to);
    move(edge.to, edge.from);
    return true;
}

void draw_edge(
    const Camera& camera, const Edge& edge, const std::vector<float>& depth, const BoxLines& lines, Canvas& canvas) {
    const auto on_screen = [&](const Vec3& p) {
        const auto q = camera.project_camera(p);
        return std::array<double, 2>{q.x, q.y};
    };
    const auto a = on_screen(edge.from), b = on_screen(edge.to);
    const bool steep = std::abs(b[1] - a[1]) > std::abs(b[0] - a[0]);
    const int major = steep ? 1 : 0, minor = 1 - major;
    const auto& first = a[major] < b[major] ? a : b;
    const auto& last = a[major] < b[major] ? b : a;
    const double za = a[major] < b[major] ? edge.from[2] : edge.to[2];
    const double zb = a[major] < b[major] ? edge.to[2] : edge.from[2];
    const int limit = steep ? canvas.height : canvas.width, across = steep ? canvas.width : canvas.height;
    const double run = std::max(last[major] - first[major], 1e-9);
    const double slope = (last[minor] - first[minor]) / run;
    const double half = 0.5 * lines.width * std::sqrt(1 + slope * slope);
    // The pieces of a bent edge follow each other without a pixel of both.
    const double inset = camera.lens() ? 0.5 : 0;
    const auto limited = [limit](double v) { return int(std::clamp(v, 0.0, double(limit))); };
    const int begin = limited(camera.lens() ? std::ceil(first[major] - inset) : std::floor(first[major]));
    const int end = limited(std::ceil(last[major] - inset));
    for (int m = begin; m < end; ++m) {
        const double t = std::clamp((m + 0.5 - first[major]) / run, 0.0, 1.0);
        const double centre = first[minor] + t * run * slope;
        // 1/z is what runs linearly over the picture.
        const double z = camera.is_perspective() ? 1 / ((1 - t) / za + t / zb) : (1 - t) * za + t * zb;
        const int low = int(std::clamp(std::floor(centre - half - 1), 0.0, double(across)));
        const int high = int(std::clamp(std::ceil(centre + half + 1), 0.0, double(across)));
        for (int n = low; n < high; ++n) {
            const std::size_t i = steep ? std::size_t(m) * canvas.width + n : std::size_t(n) * canvas.width + m;
            if (z > depth[i] * 1.002) continue;
            const double cover = std::clamp(half + 0.5 - std::abs(n + 0.5 - centre), 0.0, 1.0);
            canvas.light[i] = mix(canvas.light[i], lines.colour, float(cover) * lines.opacity);
        }
    }
}
} // namespace

void draw_box(const Camera& camera, const DomainBox& box, const std::vector<float>& depth, const BoxLines& lines,
    Canvas& canvas) {
    const Vec3 size = box.max - box.min;
    const double nearest = camera.lens()             ? std::max(1e-3, 1e-3 * length(size))
                           : camera.is_perspective() ? 1e-4 * length(size)
                                                     : -1e300;
    // Through a lens edges are bent.
    const int pieces = camera.lens() ? 48 : 1;
    for (Edge edge : edges_of(camera, box)) {
        if (!clip(edge, nearest)) continue;
        const Vec3 step = (1.0 / pieces) * (edge.to - edge.from);
        for (int k = 0; k < pieces; ++k)
            draw_edge(camera, {edge.from + double(k) * step, edge.from + double(k + 1) * step}, depth, lines, canvas);
    }
}

} // namespace treacle::video
