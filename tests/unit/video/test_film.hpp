#pragma once
#include "video/clip/clip_writer.hpp"
#include "video/film/film_look.hpp"
#include "video/mask/mask.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <vector>

namespace treacle::test {

// Films whose silhouettes are known: a puddle with lobes that grows and slides, from `begin` to `rest` [s].
struct TestFilm {
    video::FilmLook look;
    std::array<double, 3> liquid{0.05, 0.04, 0.03}; // light
    double begin = 1, rest = 3;                     // [s]
    double size = 0.3;                              // largest radius over the picture's height
    std::vector<double> times;                      // of the frames [s]

    // Distance from the contour [px], negative inside.
    double distance(double x, double y, double time) const {
        const double grown = std::clamp((time - begin) / (rest - begin), 0.0, 1.0);
        if (time < begin) return 1e9;
        const double radius = size * look.height * std::sqrt(0.02 + 0.98 * grown);
        const double u = x - look.width * (0.4 + 0.15 * grown), v = y - look.height * 0.5;
        const double r = std::hypot(u, v), angle = std::atan2(v, u);
        const double edge = radius * (1 + 0.2 * std::cos(3 * angle + 0.4) + 0.06 * std::sin(7 * angle));
        const double slope =
            radius * (-0.6 * std::sin(3 * angle + 0.4) + 0.42 * std::cos(7 * angle)) / std::max(r, 1.0);
        return (r - edge) / std::sqrt(1 + slope * slope);
    }

    video::Mask mask(double time) const {
        video::Mask mask{look.width, look.height, std::vector<std::uint8_t>(std::size_t(look.width * look.height))};
        for (int y = 0; y < look.height; ++y)
            for (int x = 0; x < look.width; ++x)
                mask.pixels[std::size_t(y * look.width + x)] =
                    distance(x, y, time) < 0 ? video::mask_liquid : video::mask_background;
        return mask;
    }

    video::FilmLight light(double time) const {
        video::FilmLight light;
        for (int y = 0; y < look.height; ++y)
            for (int x = 0; x < look.width; ++x) {
                const double d = distance(x, y, time);
                light.coverage.push_back(float(std::clamp(0.5 - d, 0.0, 1.0)));
                const double shade = 1 + 0.15 * std::sin(0.02 * x + 0.01 * y); // a lit surface is uneven
                for (const double c : liquid) light.liquid.push_back(float(c * shade));
            }
        return light;
    }

    double phase(std::size_t k) const { return double(k) / double(times.size()); }

    void write(const std::filesystem::path& path, const video::ClipOptions& wanted = {}) const {
        auto options = wanted;
        options.width = look.width;
        options.height = look.height;
        video::ClipWriter writer(path, options);
        const video::FilmPainter painter(look);
        for (std::size_t k = 0; k < times.size(); ++k)
            writer.add(painter.paint(light(times[k]), phase(k), k), times[k]);
        writer.finish();
    }
};

inline std::vector<double> steady_times(int count, double rate, double first = 0) {
    std::vector<double> times;
    for (int k = 0; k < count; ++k) times.push_back(first + k / rate);
    return times;
}

} // namespace treacle::test
