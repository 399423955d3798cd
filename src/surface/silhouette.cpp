#include "surface/silhouette.hpp"

#include "base/error.hpp"
#include "surface/projection.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::surface {

namespace {
constexpr double nothing = 1e300;
constexpr double parts = 256;           // of a pixel: corners are rounded to them
constexpr double farthest = 1 << 20;    // [pixels] of a corner outside of the picture
constexpr int deepest = 12;             // splits of a triangle one within the other
} // namespace

Seen Projection::at(const Vec3& in_camera) const {
    Seen out{in_camera, 0, 0};
    if (in_camera[2] >= near) {
        const auto pixel = camera_.project_camera(in_camera);
        out.x = std::clamp(pixel.x, -farthest, farthest);
        out.y = std::clamp(pixel.y, -farthest, farthest);
    }
    return out;
}

Seen Projection::see(const double* position, const double* velocity) const {
    const double middle = 0.5 * (camera_.lens().height - 1);
    double time = exposure_.shift;
    Seen out;
    // The row that a point is seen in depends on the time, and the time on the row.
    const int rounds = velocity != nullptr && exposure_.row_time != 0 ? 3 : 1;
    for (int round = 0; round < rounds; ++round) {
        Vec3 x{position[0], position[1], position[2]};
        if (velocity != nullptr) {
            for (std::size_t k = 0; k < 3; ++k) x[k] += time * velocity[k];
        }
        out = at(camera_.to_camera(x));
        const double row = std::clamp(out.y, 0.0, double(camera_.lens().height - 1));
        time = exposure_.shift + exposure_.row_time * (row - middle);
    }
    return out;
}

Seen Projection::middle(const Seen& a, const Seen& b) const {
    Vec3 m;
    for (std::size_t k = 0; k < 3; ++k) m[k] = 0.5 * (a.camera[k] + b.camera[k]);
    return at(m);
}

bool Projection::bent(const Seen& a, const Seen& b, double straightness) const {
    const bool swap = std::pair(b.x, b.y) < std::pair(a.x, a.y);
    const Seen& p = swap ? b : a;
    const Seen& q = swap ? a : b;
    const Seen m = middle(p, q);
    const double dx = q.x - p.x, dy = q.y - p.y, length = std::hypot(dx, dy);
    if (length < straightness) return false;
    return std::abs(dx * (m.y - p.y) - dy * (m.x - p.x)) > straightness * length;
}

std::int64_t Silhouette::count() const { return std::count(mask.begin(), mask.end(), std::uint8_t{1}); }

namespace {
// Draws depths of triangles: the nearest of each pixel.
class Raster {
public:
    Raster(int width, int height) : width_(width), height_(height) {
        depth.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), nothing);
    }

    void draw(const Seen& a, const Seen& b, const Seen& c) {
        std::int64_t x[3], y[3];
        double inverse[3];
        const Seen* corners[3] = {&a, &b, &c};
        for (int k = 0; k < 3; ++k) {
            x[k] = std::llround(corners[k]->x * parts);
            y[k] = std::llround(corners[k]->y * parts);
            inverse[k] = 1 / corners[k]->camera[2];
        }
        std::int64_t area = cross(x[0], y[0], x[1], y[1], x[2], y[2]);
        if (area == 0) return;
        if (area < 0) { // seen from behind: it covers the same pixels
            std::swap(x[1], x[2]);
            std::swap(y[1], y[2]);
            std::swap(inverse[1], inverse[2]);
            area = -area;
        }
        const auto unit = static_cast<std::int64_t>(parts);
        const auto pixel_up = [&](std::int64_t v) { return v >= 0 ? (v + unit - 1) / unit : -(-v / unit); };
        const auto pixel_down = [&](std::int64_t v) { return v >= 0 ? v / unit : -((-v + unit - 1) / unit); };
        const auto left = std::max<std::int64_t>(0, pixel_up(std::min({x[0], x[1], x[2]})));
        const auto right = std::min<std::int64_t>(width_ - 1, pixel_down(std::max({x[0], x[1], x[2]})));
        const auto top = std::max<std::int64_t>(0, pixel_up(std::min({y[0], y[1], y[2]})));
        const auto bottom = std::min<std::int64_t>(height_ - 1, pixel_down(std::max({y[0], y[1], y[2]})));
        for (auto row = top; row <= bottom; ++row) {
            for (auto column = left; column <= right; ++column) {
                std::int64_t w[3];
                bool inside = true;
                for (int k = 0; k < 3 && inside; ++k) {
                    const int i = (k + 1) % 3, j = (k + 2) % 3;
                    w[k] = cross(x[i], y[i], x[j], y[j], column * unit, row * unit);
                    // Rows go down: the liquid is on the right of an edge. Left edges go up, top edges to the right.
                    const bool owns = y[j] < y[i] || (y[j] == y[i] && x[j] > x[i]);
                    inside = w[k] > 0 || (w[k] == 0 && owns);
                }
                if (!inside) continue;
                const double sum = (double(w[0]) * inverse[0] + double(w[1]) * inverse[1] + double(w[2]) * inverse[2]) / double(area);
                auto& nearest = depth[static_cast<std::size_t>(row * width_ + column)];
                nearest = std::min(nearest, 1 / sum);
            }
        }
    }

    std::vector<double> depth;

private:
    static std::int64_t cross(std::int64_t ax, std::int64_t ay, std::int64_t bx, std::int64_t by, std::int64_t px, std::int64_t py) {
        return (bx - ax) * (py - ay) - (by - ay) * (px - ax);
    }
    int width_, height_;
};

// Splits the triangle at edges whose images are bent; both triangles of an edge split it alike.
void split(const Projection& projection, Raster& raster, double straightness, const Seen corner[3], int level) {
    bool bent[3];
    int count = 0;
    for (int k = 0; k < 3; ++k) {
        bent[k] = level < deepest && projection.bent(corner[k], corner[(k + 1) % 3], straightness);
        count += bent[k] ? 1 : 0;
    }
    if (count == 0) return raster.draw(corner[0], corner[1], corner[2]);
    Seen m[3];
    for (int k = 0; k < 3; ++k) {
        if (bent[k]) m[k] = projection.middle(corner[k], corner[(k + 1) % 3]);
    }
    const auto part = [&](const Seen& a, const Seen& b, const Seen& c) {
        const Seen three[3] = {a, b, c};
        split(projection, raster, straightness, three, level + 1);
    };
    if (count == 3) {
        for (int k = 0; k < 3; ++k) part(corner[k], m[k], m[(k + 2) % 3]);
        return part(m[0], m[1], m[2]);
    }
    int first = 0;
    while (!bent[first]) ++first;
    if (count == 2 && bent[(first + 2) % 3]) first = (first + 2) % 3; // the two bent edges follow each other
    const Seen &a = corner[first], &b = corner[(first + 1) % 3], &c = corner[(first + 2) % 3];
    if (count == 1) {
        part(a, m[first], c);
        return part(m[first], b, c);
    }
    const Seen& next = m[(first + 1) % 3];
    part(m[first], b, next);
    part(a, m[first], next);
    part(a, next, c);
}

// The part of a triangle in front of the near plane.
void clip(const Projection& projection, Raster& raster, double straightness, const Seen corner[3]) {
    Seen kept[4];
    int n = 0;
    for (int k = 0; k < 3; ++k) {
        const Seen &a = corner[k], &b = corner[(k + 1) % 3];
        if (projection.in_front(a)) kept[n++] = a;
        if (projection.in_front(a) == projection.in_front(b)) continue;
        const bool swap = projection.in_front(b); // from the end in front, whichever comes first
        const Vec3 &from = swap ? b.camera : a.camera, &to = swap ? a.camera : b.camera;
        const double t = (from[2] - Projection::near) / (from[2] - to[2]);
        kept[n++] = projection.at({from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]), Projection::near});
    }
    for (int k = 2; k < n; ++k) {
        const Seen three[3] = {kept[0], kept[k - 1], kept[k]};
        split(projection, raster, straightness, three, 0);
    }
}
} // namespace

Silhouette draw_silhouette(const Comm& comm, const Mesh& mesh, const scene::CameraModel& camera, const Exposure& exposure,
                           const HidingTriangles* solids, double straightness) {
    if (mesh.dimensions != 3) throw InputError({"silhouette", "the surface is two-dimensional", "a camera sees surfaces in space", "use a scene in 3D"});
    const int width = camera.lens().width, height = camera.lens().height;
    const Projection projection(camera, exposure);
    Raster raster(width, height);
    std::vector<Seen> seen(static_cast<std::size_t>(mesh.size()));
    for (std::size_t v = 0; v < seen.size(); ++v) {
        seen[v] = projection.see(mesh.vertices.data() + 3 * v, mesh.velocity.empty() ? nullptr : mesh.velocity.data() + 3 * v);
    }
    for (const auto& t : mesh.triangles) {
        const Seen corner[3] = {seen[static_cast<std::size_t>(t[0])], seen[static_cast<std::size_t>(t[1])], seen[static_cast<std::size_t>(t[2])]};
        clip(projection, raster, straightness, corner);
    }
    for (double& depth : raster.depth) depth = -depth;
    comm.max(std::span<double>(raster.depth));
    Silhouette out{width, height, {}, std::move(raster.depth)};
    for (double& depth : out.depth) depth = -depth;
    if (solids != nullptr) {
        Raster before(width, height);
        const Projection at_rest(camera, {});
        for (const auto& t : solids->triangles) {
            Seen corner[3];
            for (std::size_t k = 0; k < 3; ++k) corner[k] = at_rest.see(solids->vertices.data() + 3 * static_cast<std::size_t>(t[k]), nullptr);
            clip(at_rest, before, straightness, corner);
        }
        for (std::size_t k = 0; k < out.depth.size(); ++k) {
            if (before.depth[k] < out.depth[k]) out.depth[k] = nothing;
        }
    }
    out.mask.resize(out.depth.size());
    for (std::size_t k = 0; k < out.depth.size(); ++k) out.mask[k] = out.depth[k] < nothing ? 1 : 0;
    return out;
}

std::int64_t mismatches(const Silhouette& a, const Silhouette& b) {
    std::int64_t out = 0;
    for (std::size_t k = 0; k < a.mask.size(); ++k) out += a.mask[k] != b.mask[k] ? 1 : 0;
    return out;
}

} // namespace treacle::surface
