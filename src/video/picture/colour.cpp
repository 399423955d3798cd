#include "video/picture/colour.hpp"

#include "base/text/error.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace treacle::video {

namespace {
// Control points at equal distances; between them colours are mixed in a space that is even to the eye.
constexpr std::array<Rgb8, 10> viridis_points{{{68, 1, 84}, {72, 40, 120}, {62, 74, 137}, {49, 104, 142},
    {38, 130, 142}, {31, 158, 137}, {53, 183, 121}, {109, 205, 89}, {180, 222, 44}, {253, 231, 37}}};
constexpr std::array<Rgb8, 7> diverging_points{
    {{28, 62, 128}, {62, 122, 185}, {158, 196, 221}, {242, 240, 236}, {232, 174, 140}, {202, 92, 70}, {128, 24, 42}}};

float decode(std::uint8_t value) {
    const float v = value / 255.0f;
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

std::uint8_t encode(float v) {
    v = std::clamp(v, 0.0f, 1.0f);
    const float e = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
    return static_cast<std::uint8_t>(std::lround(255 * e));
}

// Oklab (Ottosson 2020): equal steps look equal.
Vec3f to_oklab(const Vec3f& c) {
    const float l = std::cbrt(0.4122214708f * c[0] + 0.5363325363f * c[1] + 0.0514459929f * c[2]);
    const float m = std::cbrt(0.2119034982f * c[0] + 0.6806995451f * c[1] + 0.1073969566f * c[2]);
    const float s = std::cbrt(0.0883024619f * c[0] + 0.2817188376f * c[1] + 0.6299787005f * c[2]);
    return {0.2104542553f * l + 0.7936177850f * m - 0.0040720468f * s,
        1.9779984951f * l - 2.4285922050f * m + 0.4505937099f * s,
        0.0259040371f * l + 0.7827717662f * m - 0.8086757660f * s};
}

Vec3f from_oklab(const Vec3f& c) {
    const auto cube = [](float v) { return v * v * v; };
    const float l = cube(c[0] + 0.3963377774f * c[1] + 0.2158037573f * c[2]);
    const float m = cube(c[0] - 0.1055613458f * c[1] - 0.0638541728f * c[2]);
    const float s = cube(c[0] - 0.0894841775f * c[1] - 1.2914855480f * c[2]);
    return {4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s,
        -1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s,
        -0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s};
}

Rgb8 between(std::span<const Rgb8> points, double t) {
    const double position = std::clamp(t, 0.0, 1.0) * (points.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(position), points.size() - 2);
    const auto a = to_oklab(to_linear(points[i])), b = to_oklab(to_linear(points[i + 1]));
    return to_display(from_oklab(mix(a, b, float(position - i))));
}
} // namespace

Rgb8 colour_of(ColourMap map, double t) {
    return map == ColourMap::viridis ? between(viridis_points, t) : between(diverging_points, t);
}

Vec3f to_linear(const Rgb8& colour) { return {decode(colour[0]), decode(colour[1]), decode(colour[2])}; }

Rgb8 to_display(const Vec3f& linear) { return {encode(linear[0]), encode(linear[1]), encode(linear[2])}; }

ValueRange robust_range(std::span<const double> values, ColourMap map) {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]))
            throw SimulationError({"picture", "the value of particle " + std::to_string(i) + " is not finite", "",
                "draw an earlier frame, or another field"});
    if (values.empty()) return {0, 1};
    std::vector<double> sorted(values.begin(), values.end());
    const auto percentile = [&](double fraction) {
        const auto position = sorted.begin() + std::lround(fraction * (sorted.size() - 1));
        std::nth_element(sorted.begin(), position, sorted.end());
        return *position;
    };
    ValueRange range{percentile(0.01), percentile(0.99)};
    if (map == ColourMap::diverging) {
        const double size = std::max(std::abs(range.low), std::abs(range.high));
        range = {-size, size};
    }
    // Ranges below the digits of the values would colour round-off.
    const double size = std::max(std::abs(range.low), std::abs(range.high));
    if (range.high - range.low <= 1e-6 * size || size == 0) {
        const double half = size > 0 ? 0.5 * size : 0.5;
        range = {range.low - half, range.high + half};
    }
    return range;
}

std::vector<double> nice_ticks(const ValueRange& range) {
    const double extent = range.high - range.low;
    if (!(extent > 0)) return {range.low};
    const double decade = std::pow(10.0, std::floor(std::log10(extent / 5)));
    double step = decade;
    for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
        step = factor * decade;
        if (extent / step <= 6) break;
    }
    std::vector<double> ticks;
    const double tolerance = 1e-9 * step;
    for (double k = std::ceil((range.low - tolerance) / step); k * step <= range.high + tolerance; ++k)
        ticks.push_back(k == 0 ? 0 : k * step); // no minus zero
    return ticks;
}

} // namespace treacle::video
