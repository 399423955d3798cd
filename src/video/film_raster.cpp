#include "video/film_raster.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace treacle::video {

namespace {
using scene::CameraModel;

constexpr double sub = 256; // units of a sample
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

struct Corner {
    Vec3 place; // in camera axes [m]
    std::array<float, 2> light;
};

struct Screen {
    std::int64_t x, y; // [1/256 sample]
    float depth;
    std::array<float, 2> light;
};

// One instant: depth and light of each sample.
struct Buffer {
    int width, height;
    std::vector<float> depth, diffuse, highlight;

    Buffer(int w, int h) : width(w), height(h), depth(std::size_t(w) * std::size_t(h), far_away), diffuse(depth.size(), 0), highlight(depth.size(), 0) {}
    void put(int x, int y, float z, const std::array<float, 2>& light) {
        const auto i = std::size_t(y) * std::size_t(width) + std::size_t(x);
        if (z >= depth[i]) return;
        depth[i] = z;
        diffuse[i] = light[0];
        highlight[i] = light[1];
    }
};

std::int64_t side(const Screen& a, const Screen& b, std::int64_t x, std::int64_t y) { return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x); }

// Samples on an edge belong to it when it is a left or a top one of a triangle that turns from x to y.
std::int64_t edge_bias(const Screen& a, const Screen& b) { return b.y < a.y || (b.y == a.y && b.x > a.x) ? 0 : -1; }

void fill(Buffer& buffer, Screen a, Screen b, Screen c) {
    std::int64_t area = side(a, b, c.x, c.y);
    if (area == 0) return;
    if (area < 0) {
        std::swap(b, c);
        area = -area;
    }
    const auto unit_of = std::int64_t(sub);
    const auto first = [&](std::int64_t v) { return std::int64_t(std::max(0.0, std::ceil((double(v) - sub / 2) / sub))); };
    const auto last = [&](std::int64_t v, int size) { return std::min(std::int64_t(size - 1), std::int64_t(std::floor((double(v) - sub / 2) / sub))); };
    const auto x0 = first(std::min({a.x, b.x, c.x})), x1 = last(std::max({a.x, b.x, c.x}), buffer.width);
    const auto y0 = first(std::min({a.y, b.y, c.y})), y1 = last(std::max({a.y, b.y, c.y}), buffer.height);
    const auto ab = edge_bias(a, b), bc = edge_bias(b, c), ca = edge_bias(c, a);
    for (auto j = y0; j <= y1; ++j)
        for (auto i = x0; i <= x1; ++i) {
            const auto x = i * unit_of + unit_of / 2, y = j * unit_of + unit_of / 2;
            const auto wc = side(a, b, x, y), wa = side(b, c, x, y), wb = side(c, a, x, y);
            if (wc + ab < 0 || wa + bc < 0 || wb + ca < 0) continue;
            const auto u = float(double(wa) / double(area)), v = float(double(wb) / double(area)), w = 1 - u - v;
            buffer.put(int(i), int(j), u * a.depth + v * b.depth + w * c.depth,
                       {u * a.light[0] + v * b.light[0] + w * c.light[0], u * a.light[1] + v * b.light[1] + w * c.light[1]});
        }
}

// Draws one instant of the exposure.
class Instant {
public:
    Instant(const FilmMesh& mesh, const CameraModel& camera, const FilmShot& shot, double time)
        : mesh_(mesh), camera_(camera), samples_(shot.samples), buffer_(camera.lens().width * samples_, camera.lens().height * samples_) {
        move_vertices(shot, time);
        if (mesh.dimensions == 2) fill_plane();
        else
            for (const auto& t : mesh.triangles) add(corners_[std::size_t(t[0])], corners_[std::size_t(t[1])], corners_[std::size_t(t[2])]);
    }
    const Buffer& buffer() const { return buffer_; }

private:
    void move_vertices(const FilmShot& shot, double time) {
        const auto count = mesh_.position.size() / 3;
        const double height = camera_.lens().height;
        for (std::size_t i = 0; i < count; ++i) {
            const auto at = [&](double t) {
                Vec3 x;
                for (std::size_t k = 0; k < 3; ++k) x[k] = mesh_.position[3 * i + k] + (mesh_.velocity.empty() ? 0 : t * mesh_.velocity[3 * i + k]);
                return camera_.to_camera(x);
            };
            Corner corner{at(time), {1, 0}};
            if (shot.readout > 0) {
                const auto seen = camera_.project_camera(corner.place);
                if (seen.depth > CameraModel::near_plane)
                    corner.place = at(time + (std::clamp(seen.y, 0.0, height - 1) / (height - 1) - 0.5) * shot.readout);
            }
            if (!mesh_.normal.empty()) {
                const Vec3 n = scene::apply(camera_.pose().rotation, {mesh_.normal[3 * i], mesh_.normal[3 * i + 1], mesh_.normal[3 * i + 2]});
                const auto& p = corner.place;
                corner.light = shade(n, unit({-p[0], -p[1], -p[2]}));
            }
            corners_.push_back(corner);
        }
    }

    Screen to_screen(const Corner& c) const {
        const auto seen = camera_.project_camera(c.place);
        const auto fixed = [&](double v) { return std::int64_t(std::llround(std::clamp((v + 0.5) * samples_ * sub, -1e8, 1e8))); };
        return {fixed(seen.x), fixed(seen.y), float(seen.depth), c.light};
    }

    // Cut at the near plane, and drawn.
    void add(const Corner& a, const Corner& b, const Corner& c) {
        constexpr double near = 2 * CameraModel::near_plane;
        const Corner given[] = {a, b, c};
        Corner kept[4];
        int count = 0;
        for (int i = 0; i < 3; ++i) {
            const auto &p = given[i], &q = given[(i + 1) % 3];
            if (p.place[2] >= near) kept[count++] = p;
            if ((p.place[2] >= near) == (q.place[2] >= near)) continue;
            const double t = (near - p.place[2]) / (q.place[2] - p.place[2]);
            Corner cut = p;
            for (std::size_t k = 0; k < 3; ++k) cut.place[k] += t * (q.place[k] - p.place[k]);
            kept[count++] = cut;
        }
        for (int i = 2; i < count; ++i) fill(buffer_, to_screen(kept[0]), to_screen(kept[i - 1]), to_screen(kept[i]));
    }

    // Rows of samples between the segments that bound the liquid, by the sum of their turns.
    void fill_plane() {
        std::vector<std::vector<std::pair<double, int>>> rows(std::size_t(buffer_.height));
        float depth = 1;
        for (const auto& s : mesh_.triangles) {
            const auto a = to_screen(corners_[std::size_t(s[0])]), b = to_screen(corners_[std::size_t(s[1])]);
            depth = a.depth;
            const auto low = std::min(a.y, b.y), high = std::max(a.y, b.y);
            const auto first = std::max<std::int64_t>(0, std::int64_t(std::ceil((double(low) - sub / 2) / sub)));
            for (auto j = first; j < buffer_.height; ++j) {
                const double y = (double(j) + 0.5) * sub;
                if (y >= double(high)) break;
                const double x = double(a.x) + (y - double(a.y)) / double(b.y - a.y) * double(b.x - a.x);
                rows[std::size_t(j)].emplace_back(x / sub - 0.5, a.y < b.y ? 1 : -1);
            }
        }
        for (int j = 0; j < buffer_.height; ++j) {
            auto& row = rows[std::size_t(j)];
            std::ranges::sort(row);
            int turns = 0;
            for (std::size_t k = 0; k + 1 < row.size(); ++k) {
                turns += row[k].second;
                if (turns == 0) continue;
                const int last = std::min(buffer_.width - 1, int(std::ceil(row[k + 1].first)) - 1);
                for (int i = std::max(0, int(std::ceil(row[k].first))); i <= last; ++i) buffer_.put(i, j, depth, {1, 0});
            }
        }
    }

    const FilmMesh& mesh_;
    const CameraModel& camera_;
    int samples_;
    Buffer buffer_;
    std::vector<Corner> corners_;
};
} // namespace

FilmDrawing draw_liquid(const FilmMesh& mesh, const CameraModel& camera, const FilmShot& shot, const FilmDepth& hidden) {
    const int width = camera.lens().width, height = camera.lens().height, n = shot.samples;
    const auto pixels = std::size_t(width) * std::size_t(height);
    FilmDrawing out{{std::vector<float>(pixels, 0), std::vector<float>(3 * pixels, 0)}, {width, height, std::vector<std::uint8_t>(pixels, mask_background)}, FilmDepth(pixels, far_away)};
    const float weight = 1 / float(n * n * shot.instants);
    for (int instant = 0; instant < shot.instants; ++instant) {
        const double share = shot.instants > 1 ? (instant + 0.5) / shot.instants - 0.5 : 0;
        const Instant drawn(mesh, camera, shot, shot.offset + share * shot.exposure);
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
                        out.light.liquid[3 * pixel + c] += weight * (float(shot.colour[c]) * buffer.diffuse[i] + float(shot.gloss) * buffer.highlight[i]);
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
