#pragma once
#include "video/picture/vector.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace treacle::video {

using Rgb8 = std::array<std::uint8_t, 3>; // sRGB: red, green, blue

// viridis: from dark violet through green to yellow, even to the eye and in grey.
// diverging: blue, nearly white in the middle, red; for signed fields.
enum class ColourMap { viridis, diverging };

// The map at t in [0, 1]; outside, the colour of the nearer end. sRGB.
Rgb8 colour_of(ColourMap map, double t);

Vec3f to_linear(const Rgb8& colour);  // each component in [0, 1], proportional to light
Rgb8 to_display(const Vec3f& linear); // components outside [0, 1] take the nearer end

// Values that the two ends of a colour map stand for, in the field's unit.
struct ValueRange {
    double low = 0, high = 1; // low <= high
};

// From the 1st to the 99th percentile, so that a few wild particles do not dim all others. Maps that diverge
// get a range symmetric about zero. A constant field gets a range around its value; no values: [0, 1].
// SimulationError for a value that is not finite.
ValueRange robust_range(std::span<const double> values, ColourMap map);

// Multiples of 1, 2 or 5 times a power of ten inside the range: 2 to 7 of them where low < high.
std::vector<double> nice_ticks(const ValueRange& range);

} // namespace treacle::video
