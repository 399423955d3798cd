#include "video/silhouette/brightness.hpp"

#include "base/median.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace treacle::video {

namespace {
constexpr int band_width = 16; // [grey levels]
constexpr int bands = 256 / band_width;
constexpr int stride = 4;          // of the pixels that are compared
constexpr std::size_t least = 150; // pixels in a band
constexpr int clipped = 251;

using Curve = std::array<float, 256>; // background's level over that of the frame

struct Knot {
    double level, ratio; // of the frame; background over frame
};

// Straight between the knots, constant outside.
Curve curve_of(std::vector<Knot> knots) {
    std::ranges::sort(knots, {}, &Knot::level);
    Curve curve;
    for (int v = 0; v < 256; ++v) {
        double ratio = 1;
        if (!knots.empty()) {
            const auto above = std::ranges::find_if(knots, [&](const Knot& k) { return k.level >= v; });
            if (above == knots.begin())
                ratio = knots.front().ratio;
            else if (above == knots.end())
                ratio = knots.back().ratio;
            else {
                const auto& a = *(above - 1);
                ratio = a.ratio + (v - a.level) / (above->level - a.level) * (above->ratio - a.ratio);
            }
        }
        curve[std::size_t(v)] = float(v * ratio);
    }
    return curve;
}
} // namespace

MatchedFrame match_brightness(const Image& frame, const std::vector<float>& mean, const Mask& foreground) {
    MatchedFrame matched{frame, 1};
    std::vector<float> gains;
    for (std::size_t c = 0; c < 3; ++c) {
        std::array<std::vector<float>, bands> ratios, levels;
        for (int y = 0; y < frame.height; y += stride)
            for (int x = 0; x < frame.width; x += stride) {
                if (!foreground.pixels.empty() && foreground.at(x, y) != mask_background) continue;
                const auto i = 3 * (std::size_t(y) * std::size_t(frame.width) + std::size_t(x)) + c;
                const int value = frame.pixels[i];
                if (value < 3 || value >= clipped || mean[i] < 3 || mean[i] >= clipped) continue;
                const auto band = std::size_t(mean[i]) / band_width;
                ratios[band].push_back(mean[i] / float(value));
                levels[band].push_back(float(value));
            }
        std::vector<Knot> knots;
        for (std::size_t b = 0; b < bands; ++b) {
            if (ratios[b].size() < least) continue;
            gains.insert(gains.end(), ratios[b].begin(), ratios[b].end());
            knots.push_back({upper_median(levels[b]), upper_median(ratios[b])});
        }
        const auto curve = curve_of(knots);
        for (std::size_t i = c; i < matched.image.pixels.size(); i += 3) {
            const int value = frame.pixels[i];
            const bool both_clipped =
                value >= clipped && mean[i] * (mean[i] / std::max(1.0F, curve[std::size_t(value)])) >= clipped;
            const float level = both_clipped ? mean[i] : curve[std::size_t(value)];
            matched.image.pixels[i] = std::uint8_t(std::lround(std::clamp(level, 0.0F, 255.0F)));
        }
    }
    if (!gains.empty()) matched.gain = 1 / upper_median(gains);
    return matched;
}

} // namespace treacle::video
