#include "video/film/film_raster.hpp"

#include "scene/camera/triangle_raster.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace treacle::video {

namespace {
using scene::CameraModel;

constexpr float far_away = 1e30F;
const Vec3 lamp{-0.37, -0.74, -0.56}; // towards the light, in camera axes: from above, left, behind the camera

double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 unit(const Vec3& a) {
    const double length = std::sqrt(dot(a, a));
    return length > 0 ? Vec3{a[0] / length, a[1] / length, a[2] / length} : a;
}

// Diffuse light and highlight of a surface with a unit normal, seen along `view` (from the point to the camera).
std::array<float, 2> shade(const Vec3& normal, const Vec3& view) {
    const double lit = std::max(0.0, dot(normal, lamp));
    const Vec3 half = unit({lamp[0] + view[0], lamp[1] + view[1], lamp[2] + view[2]});
    return {float(0.45 + 0.55 * lit), float(std::pow(std::max(0.0, dot(normal, half)), 60))};
}

// A vertex as it is seen, and its light.
struct Corner {
    scene::Seen seen;
    std::array<float, 2> light;
};

// One instant: depth and light of each sample.
struct Buffer {
    int width, height;
    std::vector<float> depth, diffuse, highlight;

    Buffer(int w, int h)
        : width(w), height(h), depth(std::size_t(w) * std::size_t(h), far_away), diffuse(depth.size(), 0),
          highlight(depth.size(), 0) {}
    void put(int x, int y, float z, const std::array<float, 2>& light) {
        const auto i = std::size_t(y) * std::size_t(width) + std::size_t(x);
        if (z >= depth[i]) return;
        depth[i] = z;
        diffuse[i] = light[0];
        highlight[i] = light[1];
    }
};

// Draws one instant of the exposure.
class Instant {
public:
    Instant(const FilmMesh& mesh, const CameraModel& camera, const FilmShot& shot, double time)
        : mesh_(mesh), samples_(shot.samples),
          projection_(camera, {time, camera.lens().height > 1 ? shot.readout / (camera.lens().height - 1) : 0}),
          buffer_(camera.lens().width * samples_, camera.lens().height * samples_) {
        see_vertices();
        if (mesh.dimensions == 2)
            fill_plane();
        else
            fill_space();
    }
    const Buffer& buffer() const { return buffer_; }

private:
    void see_vertices() {
        const auto count = mesh_.position.size() / 3;
        for (std::size_t i = 0; i < count; ++i) {
            Corner corner{
                projection_.see(&mesh_.position[3 * i], mesh_.velocity.empty() ? nullptr : &mesh_.velocity[3 * i]),
                {1, 0}};
            if (!mesh_.normal.empty()) {
                const auto& rotation = projection_.camera().pose().rotation;
                const Vec3 n =
                    scene::apply(rotation, {mesh_.normal[3 * i], mesh_.normal[3 * i + 1], mesh_.normal[3 * i + 2]});
                const auto& p = corner.seen.camera;
                corner.light = shade(n, unit({-p[0], -p[1], -p[2]}));
            }
            corners_.push_back(corner);
        }
    }

    void fill_space() {
        scene::TriangleRaster raster(projection_, samples_);
        for (const auto& t : mesh_.triangles) {
            const Corner* c[3] = {
                &corners_[std::size_t(t[0])], &corners_[std::size_t(t[1])], &corners_[std::size_t(t[2])]};
            raster.draw(c[0]->seen, c[1]->seen, c[2]->seen, [&](const scene::RasterSample& sample) {
                std::array<float, 2> light{0, 0};
                for (std::size_t k = 0; k < 3; ++k)
                    for (std::size_t l = 0; l < 2; ++l) light[l] += float(sample.barycentric[k]) * c[k]->light[l];
                buffer_.put(int(sample.column), int(sample.row), float(sample.depth), light);
            });
        }
    }

    // Rows of samples between the segments that bound the liquid, by the sum of their turns.
    void fill_plane() {
        std::vector<std::vector<std::pair<double, int>>> rows(std::size_t(buffer_.height));
        float depth = 1;
        for (const auto& s : mesh_.triangles) {
            const auto &a = corners_[std::size_t(s[0])].seen, &b = corners_[std::size_t(s[1])].seen;
            depth = float(a.camera[2]);
            const auto sample_at = [&](double pixel) { return (pixel + 0.5) * samples_ - 0.5; };
            const double ax = sample_at(a.x), ay = sample_at(a.y), bx = sample_at(b.x), by = sample_at(b.y);
            const double high = std::max(ay, by);
            for (int j = int(std::max(0.0, std::ceil(std::min(ay, by)))); j < buffer_.height && j < high; ++j)
                rows[std::size_t(j)].emplace_back(ax + (j - ay) / (by - ay) * (bx - ax), ay < by ? 1 : -1);
        }
        for (int j = 0; j < buffer_.height; ++j) {
            auto& row = rows[std::size_t(j)];
            std::ranges::sort(row);
            int turns = 0;
            for (std::size_t k = 0; k + 1 < row.size(); ++k) {
                turns += row[k].second;
                if (turns == 0) continue;
                const int last = std::min(buffer_.width - 1, int(std::ceil(row[k + 1].first)) - 1);
                for (int i = std::max(0, int(std::ceil(row[k].first))); i <= last; ++i)
                    buffer_.put(i, j, depth, {1, 0});
            }
        }
    }

    const FilmMesh& mesh_;
    int samples_;
    scene::Projection projection_;
    Buffer buffer_;
    std::vector<Corner> corners_;
};
} // namespace

FilmDrawing draw_liquid(
    const FilmMesh& mesh, const CameraModel& camera, const FilmShot& shot, const FilmDepth& hidden) {
    const int width = camera.lens().width, height = camera.lens().height, n = shot.samples;
    const auto pixels = std::size_t(width) * std::size_t(height);
    FilmDrawing out{{std::vector<float>(pixels, 0), std::vector<float>(3 * pixels, 0)},
        {width, height, std::vector<std::uint8_t>(pixels, mask_background)}, FilmDepth(pixels, far_away)};
    const float weight = 1 / float(n * n * shot.instants);
    for (int instant = 0; instant < shot.instants; ++instant) {
        const double fraction = shot.instants > 1 ? (instant + 0.5) / shot.instants - 0.5 : 0;
        const Instant drawn(mesh, camera, shot, shot.offset + fraction * shot.exposure);
        const auto& buffer = drawn.buffer();
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const auto pixel = std::size_t(y) * std::size_t(width) + std::size_t(x);
                const float front = hidden.empty() ? far_away : hidden[pixel];
                for (int k = 0; k < n * n; ++k) {
                    const auto i = std::size_t(y * n + k / n) * std::size_t(buffer.width) + std::size_t(x * n + k % n);
                    if (buffer.depth[i] >= std::min(front, far_away)) continue;
                    out.light.coverage[pixel] += weight;
                    for (std::size_t c = 0; c < 3; ++c)
                        out.light.liquid[3 * pixel + c] += weight * (float(shot.colour[c]) * buffer.diffuse[i] +
                                                                        float(shot.gloss) * buffer.highlight[i]);
                    if (2 * instant + 1 != shot.instants || k != n * n / 2) continue;
                    out.mask.pixels[pixel] = mask_liquid;
                    out.depth[pixel] = buffer.depth[i];
                }
            }
    }
    for (std::size_t i = 0; i < pixels; ++i)
        if (out.light.coverage[i] > 0)
            for (std::size_t c = 0; c < 3; ++c) out.light.liquid[3 * i + c] /= out.light.coverage[i];
    return out;
}

FilmScenery draw_solids(const CameraModel& camera, const std::function<double(const Vec3&)>& distance, double far) {
    const int width = camera.lens().width, height = camera.lens().height;
    const auto pixels = std::size_t(width) * std::size_t(height);
    FilmScenery out{{std::vector<float>(pixels, 0), std::vector<float>(3 * pixels, 0)}, FilmDepth(pixels, far_away)};
    const double close = 1e-5 * far;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto ray = camera.ray({double(x), double(y)});
            const double stretch = std::sqrt(1 + ray[0] * ray[0] + ray[1] * ray[1]); // length per depth
            double depth = CameraModel::near_plane, gap = far;
            Vec3 point{0, 0, 0};
            for (int step = 0; step < 200 && depth * stretch < far; ++step) {
                point = camera.unproject({double(x), double(y)}, depth);
                gap = distance(point);
                if (gap < close) break;
                depth += gap / stretch;
            }
            if (gap >= close) continue;
            Vec3 normal;
            for (std::size_t k = 0; k < 3; ++k) {
                auto ahead = point, behind = point;
                ahead[k] += 10 * close;
                behind[k] -= 10 * close;
                normal[k] = distance(ahead) - distance(behind);
            }
            const auto i = std::size_t(y) * std::size_t(width) + std::size_t(x);
            const auto light = shade(scene::apply(camera.pose().rotation, unit(normal)), unit({-ray[0], -ray[1], -1}));
            out.depth[i] = float(depth);
            out.light.coverage[i] = 1;
            for (std::size_t c = 0; c < 3; ++c) out.light.liquid[3 * i + c] = 0.35F * light[0] + 0.1F * light[1];
        }
    return out;
}

} // namespace treacle::video
