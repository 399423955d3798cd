#include "video/drawing/shading.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::video {

namespace {
constexpr int shadow_pixels = 1400;

View shadow_view(const DirectionalLight& lamp, std::span<const Sphere> around) {
    Vec3 low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
    double largest = 0;
    for (const auto& [centre, radius] : around) {
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], double(centre[a]));
            high[a] = std::max(high[a], double(centre[a]));
        }
        largest = std::max(largest, double(radius));
    }
    if (around.empty()) low = high = {0, 0, 0};
    const double radius = std::max(0.5 * length(high - low) + 4 * largest, 1e-9);
    const Vec3 towards{lamp.towards[0], lamp.towards[1], lamp.towards[2]};
    View view;
    view.target = 0.5 * (low + high);
    view.position = view.target + (4 * radius) * towards;
    view.up = std::abs(towards[0]) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    view.vertical_field_of_view = 2 * std::atan(0.25);
    view.width = view.height = shadow_pixels;
    view.projection = Projection::orthographic;
    return view;
}
} // namespace

DirectionalLight lamp_of(const Camera& camera, const Vec3& world_up) {
    const Vec3f up = normalised(single(camera.direction_to_camera(world_up)));
    const Vec3f towards = normalised(1.0f * up + 0.5f * Vec3f{-1, 0, 0} + 0.85f * Vec3f{0, 0, -1});
    return {towards, up};
}

Vec3 up_of(const DomainBox& domain) { return domain.dimensions == 2 ? Vec3{0, 1, 0} : Vec3{0, 0, 1}; }

Vec3f shade(const Fragment& f, const DirectionalLight& lamp) {
    const Vec3f towards_camera = normalised(-1.0f * f.point);
    const float facing = dot(f.normal, lamp.towards);
    const float lamp_light = 0.95f * std::max(0.0f, facing) * f.lit;
    const float sky = 0.40f + 0.16f * dot(f.normal, lamp.up) + 0.16f * std::max(0.0f, -f.normal[2]);
    const Vec3f half = normalised(lamp.towards + towards_camera);
    float h = std::max(0.0f, dot(f.normal, half));
    h *= h;
    h *= h;
    h *= h;
    h *= h;
    h *= h; // power 32
    const float highlight = f.gloss * h * f.lit * f.open;
    return (lamp_light + sky * f.open) * f.albedo + Vec3f{highlight, highlight, highlight};
}

ShadowMap::ShadowMap(const DirectionalLight& lamp, std::span<const Sphere> around)
    : camera_(shadow_view(lamp, around)), buffer_(shadow_pixels, shadow_pixels) {
    float radius = 0;
    for (const auto& sphere : around) radius = std::max(radius, sphere.radius);
    bias_ = std::max(0.7f * radius, 3 / float(camera_.scale()));
}

void ShadowMap::add(std::span<const Sphere> casters) {
    std::vector<Sphere> seen(casters.begin(), casters.end());
    for (auto& [centre, radius] : seen) centre = single(camera_.to_camera({centre[0], centre[1], centre[2]}));
    splat(camera_, seen, buffer_);
}

void ShadowMap::merge(std::span<const float> depth) {
    for (std::size_t i = 0; i < depth.size(); ++i) buffer_.depth[i] = std::min(buffer_.depth[i], depth[i]);
}

float ShadowMap::light_at(const Vec3f& point, int pattern) const {
    const auto p = camera_.project({point[0], point[1], point[2]});
    constexpr std::array<std::array<float, 2>, 4> corners{{{-1.f, -1.f}, {1.f, -1.f}, {-1.f, 1.f}, {1.f, 1.f}}};
    constexpr float spread = 1.6f; // [pixels of the map]
    float lit = 0;
    for (const auto& corner : corners) {
        const float shift = 0.45f * corners[pattern][0], lift = 0.45f * corners[pattern][1];
        const int column = int(std::floor(p.x + spread * (corner[0] + shift)));
        const int row = int(std::floor(p.y + spread * (corner[1] + lift)));
        const bool outside = column < 0 || row < 0 || column >= buffer_.width || row >= buffer_.height;
        if (outside || p.depth - bias_ <= buffer_.depth[std::size_t(row) * buffer_.width + column]) lit += 0.25f;
    }
    return lit;
}

std::vector<float> reduce_depth(const std::vector<float>& depth, int width, int height, int factor) {
    std::vector<float> nearest(std::size_t(width / factor) * (height / factor), far_away);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            float& n = nearest[std::size_t(row / factor) * (width / factor) + column / factor];
            n = std::min(n, depth[std::size_t(row) * width + column]);
        }
    return nearest;
}

namespace {
constexpr int directions = 16, pairs = 5, tile = 4;

struct Offset {
    float x, y, fraction; // fraction of the radius at which the sample lies
};

// Per pixel of a 4 x 4 tile, sample offsets turned by another angle; averaging a tile joins them again.
std::array<std::array<Offset, pairs>, tile * tile> sample_offsets() {
    std::array<std::array<Offset, pairs>, tile * tile> offsets{};
    for (int p = 0; p < tile * tile; ++p)
        for (int k = 0; k < pairs; ++k) {
            const float turn = float((7 * p) % directions) / directions;
            const float angle = 3.14159265f * (turn / pairs + float(k) / pairs);
            const float fraction = std::sqrt((k + 0.5f + 0.4f * std::sin(2.4f * p)) / pairs);
            offsets[p][k] = {std::cos(angle) * fraction, std::sin(angle) * fraction, fraction};
        }
    return offsets;
}

std::vector<float> average_tiles(
    const std::vector<float>& raw, const std::vector<float>& depth, int width, int height, float radius) {
    std::vector<float> smooth(raw.size(), 1.0f);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const std::size_t i = std::size_t(row) * width + column;
            if (depth[i] == far_away) continue;
            float sum = 0, weight = 0;
            for (int y = std::max(row - 2, 0); y < std::min(row + 2, height); ++y)
                for (int x = std::max(column - 2, 0); x < std::min(column + 2, width); ++x) {
                    const std::size_t j = std::size_t(y) * width + x;
                    const float same = std::abs(depth[j] - depth[i]) < 0.5f * radius ? 1.0f : 0.0f;
                    sum += same * raw[j];
                    weight += same;
                }
            smooth[i] = weight > 0 ? sum / weight : raw[i];
        }
    return smooth;
}
} // namespace

// Samples come in opposite pairs, so that a plane, however slanted, hides nothing of itself.
std::vector<float> ambient_occlusion(const Camera& camera, const std::vector<float>& depth, float radius) {
    const int width = camera.width(), height = camera.height();
    static const auto offsets = sample_offsets();
    std::vector<float> open(depth.size(), 1.0f);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const std::size_t i = std::size_t(row) * width + column;
            const float z = depth[i];
            if (z == far_away) continue;
            const float scale = float(camera.scale()) * (camera.is_perspective() ? 1 / z : 1.0f);
            const float pixels = std::clamp(radius * scale, 2.0f, 80.0f);
            const auto rise = [&](float x, float y, float room) {
                const int c = std::clamp(int(std::lround(column + x)), 0, width - 1);
                const int r = std::clamp(int(std::lround(row + y)), 0, height - 1);
                const float nearer = z - depth[std::size_t(r) * width + c];
                // Things far in front are no part of this surface; they only count as half in the way.
                return nearer > 2 * radius ? 0.3f * room : std::clamp(nearer, -radius, room);
            };
            float hidden = 0;
            for (const auto& [x, y, fraction] : offsets[std::size_t(row % tile) * tile + column % tile]) {
                const float room = radius * std::sqrt(std::max(1 - fraction * fraction, 0.05f));
                const float both = rise(pixels * x, pixels * y, room) + rise(-pixels * x, -pixels * y, room);
                hidden += std::max(both, 0.0f) / (2 * room);
            }
            open[i] = std::max(0.0f, 1 - 1.5f * hidden / pairs);
        }
    return average_tiles(open, depth, width, height, radius);
}

} // namespace treacle::video
