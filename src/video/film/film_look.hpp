#pragma once
#include "video/picture/image.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace treacle::video {

// Look of a scene in a camera: what stands between light and the numbers of a video. Light is linear, 1 is white.
struct FilmLook {
    int width = 1280, height = 720;
    std::array<double, 3> background{0.6, 0.62, 0.65}; // mean light
    double texture = 0.15;                             // relative amplitude of the background's pattern
    double uneven_light = 0.1;                         // relative fall of the light from the middle to the corners
    double exposure_drift = 0;                         // relative: the exposure goes up and down by it over the clip
    double blur = 0.8;                                 // standard deviation of the lens' and the sensor's blur [px]
    double noise = 1.5;                                // standard deviation [grey levels of 255]
    double shadow = 0;                                 // darkness of a soft shadow beside the liquid, 0 to 1
    bool blur_code = false;                            // blur the numbers instead of the light, as picture editors do
    std::array<double, 2> shake{0, 0};                 // shift of the whole picture [px]
    std::uint64_t seed = 1;
};

// Light of a scene: `coverage` [height][width] is the liquid's share of each pixel, `liquid` [height][width][3] its light.
struct FilmLight {
    std::vector<float> coverage, liquid; // [height][width] 0 to 1; [height][width][3] linear, red green blue
};

// Draws frames of one clip; the background is made once.
class FilmPainter {
public:
    // `scenery`: solids before the background, or none.
    explicit FilmPainter(const FilmLook& look, const FilmLight& scenery = {});
    // `phase` of the clip in [0, 1], for the drift of the exposure; `frame` seeds the noise.
    Image paint(const FilmLight& light, double phase, std::uint64_t frame) const;
    Image paint_empty(double phase, std::uint64_t frame) const;

private:
    FilmLook look_;
    std::vector<float> background_; // [height][width][3]
};

// sRGB's transfer (IEC 61966-2-1): light 0..1 from a number 0..1, and back.
double light_of_code(double code);
double code_of_light(double light);

} // namespace treacle::video
