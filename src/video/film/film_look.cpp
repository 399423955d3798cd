#include "video/film/film_look.hpp"

#include "video/mask/pixels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {
std::uint64_t mix(std::uint64_t x) { // splitmix64, Steele et al. 2014
    x += 0x9e3779b97f4a7c15;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
}

double uniform(std::uint64_t key) { return static_cast<double>(mix(key) >> 11) * 0x1p-53; }

// Sum of four uniform numbers of 16 bits, of mean 0 and variance 1.
float normal(std::uint64_t key) {
    const auto bits = mix(key);
    const auto sum = (bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48);
    return (static_cast<float>(sum) / 65536.0F - 2.0F) * 1.7320508F;
}

// Smooth noise of one octave in [-1, 1]: random values on a lattice of `cell` pixels.
double value_noise(double x, double y, double cell, std::uint64_t seed) {
    const double u = x / cell, v = y / cell;
    const auto i = static_cast<std::int64_t>(std::floor(u)), j = static_cast<std::int64_t>(std::floor(v));
    const auto at = [&](std::int64_t a, std::int64_t b) {
        return 2 * uniform(seed ^
                           (static_cast<std::uint64_t>(a) * 0x8da6b343 + static_cast<std::uint64_t>(b) * 0xd8163841)) -
               1;
    };
    const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
    const double s = smooth(u - double(i)), t = smooth(v - double(j));
    return (1 - t) * ((1 - s) * at(i, j) + s * at(i + 1, j)) + t * ((1 - s) * at(i, j + 1) + s * at(i + 1, j + 1));
}

std::vector<float> make_background(const FilmLook& look) {
    std::vector<float> light(3 * std::size_t(look.width) * std::size_t(look.height));
    const double corner = std::hypot(look.width, look.height) / 2;
    for (int y = 0; y < look.height; ++y)
        for (int x = 0; x < look.width; ++x) {
            const double u = x + look.shake[0], v = y + look.shake[1];
            double pattern = 0;
            for (const double cell : {60.0, 19.0, 6.0})
                pattern += value_noise(u, v, cell, look.seed * 977 + std::uint64_t(cell)) / 1.8;
            const double r = std::hypot(x - look.width / 2.0, y - look.height / 2.0) / corner;
            for (std::size_t c = 0; c < 3; ++c)
                light[3 * (std::size_t(y) * std::size_t(look.width) + std::size_t(x)) + c] =
                    float(look.background[c] * (1 + look.texture * pattern) * (1 - look.uneven_light * r * r));
        }
    return light;
}

std::uint8_t code(double light) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(light, 0.0, 1.0))); }

// Light to a number of 0..255 with a fraction, by linear interpolation.
class CodeTable {
public:
    CodeTable() {
        for (std::size_t i = 0; i < table_.size(); ++i) table_[i] = float(255 * code_of_light(double(i) / steps));
    }
    float at(float light) const {
        const float x = std::clamp(light, 0.0F, 1.0F) * steps;
        const auto i = std::min(static_cast<std::size_t>(x), std::size_t(steps - 1));
        return table_[i] + (x - float(i)) * (table_[i + 1] - table_[i]);
    }

private:
    static constexpr int steps = 1 << 14;
    std::array<float, steps + 1> table_{};
};

void blur(cv::Mat& picture, double deviation) {
    if (deviation <= 0) return;
    const int size = 2 * int(std::ceil(4 * deviation)) + 1;
    cv::GaussianBlur(picture, picture, {size, size}, deviation, deviation, cv::BORDER_REPLICATE);
}
} // namespace

double light_of_code(double code) { return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4); }
double code_of_light(double light) {
    return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

FilmPainter::FilmPainter(const FilmLook& look, const FilmLight& scenery)
    : look_(look), background_(make_background(look)) {
    cv::setNumThreads(1);
    for (std::size_t i = 0; i < scenery.coverage.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const float a = scenery.coverage[i];
            background_[3 * i + c] = a * scenery.liquid[3 * i + c] + (1 - a) * background_[3 * i + c];
        }
}

Image FilmPainter::paint_empty(double phase, std::uint64_t frame) const {
    const auto pixels = std::size_t(look_.width) * std::size_t(look_.height);
    return paint({std::vector<float>(pixels, 0), std::vector<float>(3 * pixels, 0)}, phase, frame);
}

Image FilmPainter::paint(const FilmLight& light, double phase, std::uint64_t frame) const {
    static const CodeTable codes;
    const auto pixels = std::size_t(look_.width) * std::size_t(look_.height);
    cv::Mat picture(look_.height, look_.width, CV_32FC3);
    auto* out = picture.ptr<float>();
    const auto exposure = float(1 + look_.exposure_drift * std::sin(2 * std::numbers::pi * phase));
    cv::Mat shade;
    if (look_.shadow > 0) {
        const cv::Mat coverage(look_.height, look_.width, CV_32F, const_cast<float*>(light.coverage.data()));
        cv::warpAffine(coverage, shade, cv::Matx23d(1, 0, 14, 0, 1, 10), coverage.size());
        blur(shade, 10);
    }
    for (std::size_t i = 0; i < pixels; ++i) {
        const float a = light.coverage[i];
        const float lit = shade.empty() ? 1.0F : 1.0F - float(look_.shadow) * shade.ptr<float>()[i];
        for (std::size_t c = 0; c < 3; ++c) {
            float value = exposure * (a * light.liquid[3 * i + c] + (1 - a) * lit * background_[3 * i + c]);
            if (look_.blur_code) value = codes.at(value);
            out[3 * i + c] = value;
        }
    }
    blur(picture, look_.blur);
    Image image{look_.width, look_.height, std::vector<std::uint8_t>(3 * pixels)};
    const auto key = mix(look_.seed * 0x51ed27 + frame);
    for (std::size_t i = 0; i < 3 * pixels; ++i) {
        const float value = look_.blur_code ? out[i] : codes.at(out[i]);
        image.pixels[i] = code((value + float(look_.noise) * normal(key + i)) / 255);
    }
    return image;
}

} // namespace treacle::video
