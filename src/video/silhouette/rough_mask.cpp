#include "video/silhouette/rough_mask.hpp"

#include "base/text/error.hpp"
#include "video/mask/pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {
cv::Mat grey_of(const Image& frame) {
    cv::Mat grey;
    cv::cvtColor(pixels_of(frame), grey, cv::COLOR_RGB2GRAY);
    return grey;
}

// True when most of the picture's edge is lighter than the level: the background is.
bool edge_is_light(const cv::Mat& grey, double level) {
    int light = 0, all = 0;
    for (int y = 0; y < grey.rows; ++y)
        for (int x = 0; x < grey.cols; ++x) {
            if (x != 0 && y != 0 && x != grey.cols - 1 && y != grey.rows - 1) continue;
            light += grey.at<std::uint8_t>(y, x) > level ? 1 : 0;
            ++all;
        }
    return 2 * light > all;
}

double median_of(const cv::Mat& grey, const cv::Mat& chosen) {
    std::array<std::size_t, 256> histogram{};
    std::size_t count = 0;
    for (int y = 0; y < grey.rows; ++y)
        for (int x = 0; x < grey.cols; ++x)
            if (chosen.at<std::uint8_t>(y, x) != 0) {
                ++histogram[grey.at<std::uint8_t>(y, x)];
                ++count;
            }
    std::size_t below = 0;
    for (std::size_t v = 0; v < 256; ++v) {
        below += histogram[v];
        if (2 * below >= count && count > 0) return double(v);
    }
    return 0;
}
} // namespace

RoughMasks::RoughMasks(const SilhouetteSettings& settings) : settings_(settings), level_(settings.level) {
    if (settings.liquid != MaskPolarity::automatic) liquid_is_dark_ = settings.liquid == MaskPolarity::dark;
}

void RoughMasks::set_level(const std::vector<double>& histogram) {
    double total = 0, sum = 0;
    for (std::size_t v = 0; v < 256; ++v) {
        total += histogram[v];
        sum += double(v) * histogram[v];
    }
    double below = 0, sum_below = 0, best = -1;
    for (std::size_t v = 0; v < 255; ++v) {
        below += histogram[v];
        sum_below += double(v) * histogram[v];
        if (below <= 0 || below >= total) continue;
        const double distance = sum_below / below - (sum - sum_below) / (total - below);
        const double between = below * (total - below) * distance * distance;
        if (between <= best) continue;
        best = between;
        // Half way between the classes' means, which a few pixels more or less do not move.
        level_ = 0.5 * (sum_below / below + (sum - sum_below) / (total - below));
    }
}

const std::vector<float>& RoughMasks::background() const {
    static const std::vector<float> none;
    return background_ ? background_->mean() : none;
}

RoughMask RoughMasks::make(const Image& frame, const Mask& before, const std::string& name) {
    switch (settings_.method) {
    case SilhouetteMethod::threshold: return by_level(frame);
    case SilhouetteMethod::colour: return by_colour(frame);
    case SilhouetteMethod::masks: return ready(frame, name);
    default: break;
    }
    if (!settings_.brightness) return {background_->classify(frame), 1, background_->shadows()};
    auto matched = match_brightness(frame, background_->mean(), before);
    auto mask = background_->classify(matched.image);
    // The liquid may have covered what the frame before left free.
    auto again = match_brightness(frame, background_->mean(), mask);
    if (std::abs(again.gain - matched.gain) > 2e-3) mask = background_->classify(again.image);
    return {std::move(mask), again.gain, background_->shadows()};
}

RoughMask RoughMasks::by_level(const Image& frame) {
    const cv::Mat grey = grey_of(frame);
    if (!liquid_is_dark_) liquid_is_dark_ = edge_is_light(grey, level_);
    RoughMask rough;
    double level = level_;
    for (int round = 0; round < 2; ++round) {
        const cv::Mat background = *liquid_is_dark_ ? cv::Mat(grey > level) : cv::Mat(grey < level);
        const double lit = median_of(grey, background);
        if (lit_ <= 0) lit_ = lit;
        rough.gain = lit_ > 0 && lit > 0 ? lit / lit_ : 1;
        if (settings_.brightness) level = level_ * rough.gain;
    }
    rough.mask = mask_of(*liquid_is_dark_ ? cv::Mat(grey < level) : cv::Mat(grey > level));
    return rough;
}

RoughMask RoughMasks::by_colour(const Image& frame) const {
    RoughMask rough;
    rough.mask = {frame.width, frame.height, std::vector<std::uint8_t>(frame.pixels.size() / 3, mask_background)};
    const double wanted[] = {settings_.colour[0], settings_.colour[1], settings_.colour[2]};
    for (std::size_t i = 0; i < rough.mask.pixels.size(); ++i) {
        double square = 0;
        for (std::size_t c = 0; c < 3; ++c) square += std::pow(frame.pixels[3 * i + c] - wanted[c], 2);
        if (square <= settings_.tolerance * settings_.tolerance) rough.mask.pixels[i] = mask_liquid;
    }
    return rough;
}

RoughMask RoughMasks::ready(const Image& frame, const std::string& name) {
    const cv::Mat grey = grey_of(frame);
    if (!liquid_is_dark_) liquid_is_dark_ = edge_is_light(grey, 127);
    const int between = cv::countNonZero((grey > 40) & (grey < 215));
    if (between > int(grey.total() / 50))
        throw InputError({name, "is no mask", std::to_string(between) + " of its pixels are neither black nor white",
            "choose another --method for a film"});
    return {mask_of(*liquid_is_dark_ ? cv::Mat(grey < 128) : cv::Mat(grey >= 128)), 1, 0};
}

} // namespace treacle::video
