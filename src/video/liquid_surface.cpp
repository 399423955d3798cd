#include "video/liquid_surface.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace treacle::video {

namespace {
constexpr float beyond = 1e30f; // far_away without its infinite differences

// How the depths are smoothed, lengths relative to the particles' spacing.
constexpr float ball_size = 0.64f;    // radius of the balls that are melted; deeper layers fill the gaps
constexpr float disc_size = 0.85f;    // in the plane nothing lies deeper: they must overlap
constexpr float filter_width = 1.15f; // standard deviation of the filter
constexpr float narrow_range = 4.0f;  // depths further apart belong to different sheets
constexpr float step_down =
    0.35f; // beyond its edge a sheet is taken to go on this far behind: edges turn round
constexpr float widest_filter = 24.0f; // standard deviation [pixels]; bounds the cost of close-ups
constexpr int rounds = 3;
constexpr float clearest = 0.35f; // share of the light from behind that the thinnest film lets through

struct Field {
    int width, height;
    std::vector<float> depth, value;
};

struct Filter {
    std::vector<float> weights; // of the taps -n..n
    float range, down;          // [m]
};

Filter filter_of(float spacing, float pixels_per_metre) {
    const float deviation = std::clamp(filter_width * spacing * pixels_per_metre, 0.8f, widest_filter);
    const int n = int(std::ceil(2.2f * deviation));
    Filter filter{{}, narrow_range * spacing, step_down * spacing};
    for (int k = -n; k <= n; ++k) filter.weights.push_back(std::exp(-0.5f * k * k / (deviation * deviation)));
    return filter;
}

// One row of one pass: adds what the tap at `other` says about the pixels at `own`.
void add_tap(const float* own, const float* other, const float* other_value, float weight,
             const Filter& filter, int n, float* sum, float* total, float* value_sum, float* value_total) {
    const float range = filter.range, down = filter.down;
#pragma GCC ivdep
    for (int i = 0; i < n; ++i) {
        const float difference = other[i] - own[i];
        const bool is_edge = difference > 3 * range;
        const float w = (std::abs(difference) <= range) | is_edge ? weight : 0.0f;
        sum[i] += w * (is_edge ? own[i] + down : other[i]);
        total[i] += w;
    }
    if (!other_value) return;
#pragma GCC ivdep
    for (int i = 0; i < n; ++i) {
        const float w = std::abs(other[i] - own[i]) <= range ? weight : 0.0f;
        value_sum[i] += w * other_value[i];
        value_total[i] += w;
    }
}

// The part [first, last) of a row outside of which there is no liquid.
std::pair<int, int> covered(const float* row, int width) {
    int first = 0, last = width;
    while (first < last && row[first] == beyond) ++first;
    while (last > first && row[last - 1] == beyond) --last;
    return {first, last};
}

// One pass along rows (dx = 1) or columns (dy = 1).
void smooth(const Field& in, Field& out, const Filter& filter, int dx, int dy) {
    const int n = int(filter.weights.size()) / 2, width = in.width;
    std::vector<float> sum(width), total(width), value_sum(width), value_total(width);
    for (int row = 0; row < in.height; ++row) {
        const float* own = in.depth.data() + std::size_t(row) * width;
        float* result = out.depth.data() + std::size_t(row) * width;
        const auto [first, last] = covered(own, width);
        std::fill(result, result + width, beyond);
        if (first == last) continue;
        for (auto* line : {&sum, &total, &value_sum, &value_total})
            std::fill(line->begin(), line->end(), 0.0f);
        for (int k = -n; k <= n; ++k) {
            const int other_row = row + k * dy;
            if (other_row < 0 || other_row >= in.height) continue;
            const int from = std::max(first, -k * dx), to = std::min(last, width - k * dx);
            if (from >= to) continue;
            const std::size_t j = std::size_t(other_row) * width + from + k * dx;
            add_tap(own + from, &in.depth[j], in.value.empty() ? nullptr : &in.value[j],
                    filter.weights[k + n], filter, to - from, &sum[from], &total[from], &value_sum[from],
                    &value_total[from]);
        }
        for (int i = first; i < last; ++i)
            if (own[i] != beyond) result[i] = sum[i] / total[i];
        if (in.value.empty()) continue;
        float* value = out.value.data() + std::size_t(row) * width;
        for (int i = first; i < last; ++i)
            if (own[i] != beyond) value[i] = value_sum[i] / value_total[i];
    }
}

// Columns after rows leave streaks where a sheet ends; a small filter over squares wipes them away.
void wipe_streaks(const Field& in, Field& out, float range) {
    constexpr int n = 4;
    const int width = in.width;
    std::vector<float> sum(width), total(width);
    for (int row = 0; row < in.height; ++row) {
        const float* own = in.depth.data() + std::size_t(row) * width;
        float* result = out.depth.data() + std::size_t(row) * width;
        const auto [first, last] = covered(own, width);
        std::fill(result, result + width, beyond);
        std::fill(sum.begin(), sum.end(), 0.0f);
        std::fill(total.begin(), total.end(), 0.0f);
        for (int dy = std::max(-n, -row); dy <= std::min(n, in.height - 1 - row); ++dy)
            for (int dx = -n; dx <= n; ++dx) {
                const int from = std::max(first, -dx), to = std::min(last, width - dx);
                const float* other = in.depth.data() + std::size_t(row + dy) * width + dx;
                const float weight = std::exp(-float(dx * dx + dy * dy) / (n * n));
#pragma GCC ivdep
                for (int i = from; i < to; ++i) {
                    const float w = std::abs(other[i] - own[i]) <= range ? weight : 0.0f;
                    sum[i] += w * other[i];
                    total[i] += w;
                }
            }
        for (int i = first; i < last; ++i)
            if (own[i] != beyond) result[i] = sum[i] / total[i];
    }
}

float mean_depth(const std::vector<float>& depth) {
    double sum = 0;
    std::size_t count = 0;
    for (const float z : depth)
        if (z != far_away) {
            sum += z;
            ++count;
        }
    return count > 0 ? float(sum / count) : 1;
}

std::vector<Sphere> swollen(std::span<const Sphere> particles, float factor) {
    std::vector<Sphere> balls(particles.begin(), particles.end());
    for (auto& ball : balls) ball.radius *= factor;
    return balls;
}

// Overlapping balls count the same liquid several times: (2 ball_size spacing / 2)^3 4 pi / 3 per spacing^3.
std::vector<float> smooth_thickness(const Camera& camera, std::span<const Sphere> balls) {
    constexpr float overlap = 4.18879f * ball_size * ball_size * ball_size;
    auto thickness = splat_thickness(camera, balls);
    for (float& t : thickness) t /= overlap;
    return thickness;
}

// The mirrored surroundings: a dim floor, a bright sky and the lamp as a soft disc.
float mirrored(const Vec3f& direction, const Lamp& lamp, float lit) {
    const float height = 0.5f + 0.5f * dot(direction, lamp.up);
    const float sky = 0.50f + 0.60f * height * height;
    const float disc = std::clamp((dot(direction, lamp.towards) - 0.88f) / 0.08f, 0.0f, 1.0f);
    return sky + 5.0f * disc * disc * (3 - 2 * disc) * lit;
}

// What a liquid's colour turns to with depth: the light that comes back has been filtered again and again.
Vec3f deepened(const Vec3f& albedo, float share) {
    Vec3f deep;
    for (int k = 0; k < 3; ++k) deep[k] = 0.85f * albedo[k] * std::sqrt(std::max(albedo[k], 0.0f));
    return mix(albedo, deep, share);
}
} // namespace

LiquidSurface melt(const Camera& camera, std::span<const Sphere> particles, std::span<const float> values) {
    const auto balls = swollen(particles, 2 * (camera.is_perspective() ? ball_size : disc_size));
    DepthBuffer buffer(camera.width(), camera.height());
    splat(camera, balls, buffer);
    LiquidSurface surface{camera.width(), camera.height(), {}, {}, smooth_thickness(camera, balls)};
    if (particles.empty()) {
        surface.depth = std::move(buffer.depth);
        return surface;
    }
    const float z = camera.is_perspective() ? mean_depth(buffer.depth) : 1;
    const Filter filter = filter_of(2 * particles[0].radius, float(camera.scale()) / z);
    Field a{camera.width(), camera.height(), std::move(buffer.depth), {}};
    for (float& depth : a.depth) depth = depth == far_away ? beyond : depth;
    if (!values.empty()) {
        a.value.resize(a.depth.size(), 0.0f);
        for (std::size_t i = 0; i < a.value.size(); ++i)
            if (buffer.sphere[i] != no_sphere) a.value[i] = values[buffer.sphere[i]];
    }
    Field b = a;
    for (int round = 0; round < rounds; ++round) {
        smooth(a, b, filter, 1, 0);
        smooth(b, a, filter, 0, 1);
    }
    wipe_streaks(a, b, filter.range);
    for (float& depth : b.depth) depth = depth == beyond ? far_away : depth;
    surface.depth = std::move(b.depth);
    surface.value = std::move(a.value);
    return surface;
}

Vec3f normal_at(const LiquidSurface& surface, const Camera& camera, int column, int row) {
    const auto depth = [&](int c, int r) {
        if (c < 0 || r < 0 || c >= surface.width || r >= surface.height) return far_away;
        return surface.depth[std::size_t(r) * surface.width + c];
    };
    const auto point = [&](int c, int r) {
        const Ray ray = ray_through(camera, c + 0.5f, r + 0.5f);
        return ray.origin + depth(c, r) * ray.direction;
    };
    const float z = depth(column, row);
    // The side on which the depth changes less lies on the same sheet.
    const auto slope = [&](int dc, int dr) {
        const float after = std::abs(depth(column + dc, row + dr) - z);
        const float before = std::abs(depth(column - dc, row - dr) - z);
        if (after == far_away && before == far_away) return Vec3f{float(dc), float(dr), 0};
        return after <= before ? point(column + dc, row + dr) - point(column, row)
                               : point(column, row) - point(column - dc, row - dr);
    };
    const Vec3f normal = normalised(cross(slope(0, 1), slope(1, 0)));
    return normal[2] > 0 ? -1.0f * normal : normal;
}

Vec3f shade_liquid(const Fragment& f, const Lamp& lamp, const Vec3f& behind, float thickness, float clarity) {
    const Vec3f into = normalised(f.point);
    const float facing = std::clamp(-dot(into, f.normal), 0.0f, 1.0f);
    // Light wanders inside the liquid before it leaves: the lamp reaches a little round the edge.
    const float wrapped = std::max(0.0f, (dot(f.normal, lamp.towards) + 0.35f) / 1.35f);
    const float sky = 0.34f + 0.18f * dot(f.normal, lamp.up) + 0.12f * facing;
    const Vec3f deep =
        clarity > 0 ? deepened(f.albedo, 1 - std::exp(-0.12f * thickness / clarity)) : f.albedo;
    const Vec3f own = (0.80f * wrapped * (0.35f + 0.65f * f.lit) + 1.1f * sky * f.open) * deep;
    Vec3f colour = own;
    if (clarity > 0) {
        const float path = thickness / clarity;
        const float through = clearest * std::exp(-path);
        Vec3f tinted = behind;
        for (int k = 0; k < 3; ++k)
            tinted[k] *= std::pow(std::max(f.albedo[k], 0.02f), 0.9f * std::min(path, 3.0f));
        colour = mix(own, tinted, through);
    }
    const float grazing = 1 - facing, power = grazing * grazing * grazing * grazing * grazing;
    const float fresnel = (0.04f + 0.55f * power) * (0.3f + 0.7f * f.open);
    const Vec3f mirror = into + (2 * facing) * f.normal;
    const float reflected = mirrored(mirror, lamp, f.lit);
    return mix(colour, Vec3f{reflected, reflected, reflected}, fresnel);
}

} // namespace treacle::video
