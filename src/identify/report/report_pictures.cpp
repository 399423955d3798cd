#include "identify/report/report_pictures.hpp"

#include "identify/experiment/observation.hpp"
#include "video/clip/movie.hpp"

#include <array>
#include <cstdio>

namespace treacle::identify {

namespace {
constexpr std::size_t most_pictures = 6;
using Colour = std::array<std::uint8_t, 3>;
constexpr Colour background{255, 255, 255}, both{150, 150, 150}, film_alone{40, 90, 200}, run_alone{210, 60, 40},
    excluded{235, 225, 190};

} // namespace

video::Image draw_differences(const video::Mask& film, const video::Mask& run) {
    video::Image out{film.width, film.height, {}};
    out.pixels.reserve(3 * film.pixels.size());
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
        const bool a = film.pixels[i] == video::mask_liquid, b = run.pixels[i] == video::mask_liquid;
        const auto& colour = film.pixels[i] == video::mask_excluded ? excluded
                             : a && b                               ? both
                             : a                                    ? film_alone
                             : b                                    ? run_alone
                                                                    : background;
        out.pixels.insert(out.pixels.end(), colour.begin(), colour.end());
    }
    return out;
}

std::vector<ReportPicture> write_pictures(const std::filesystem::path& folder, const StudyFile& file,
    const Experiment& experiment, const std::filesystem::path& run) {
    const auto frames = observed_frames(experiment, file.beside(experiment.masks));
    const auto masks = run / ("masks_" + experiment.name);
    std::vector<ReportPicture> out;
    if (!std::filesystem::exists(masks)) return out; // of another study that did not keep them
    const auto count = std::min(most_pictures, frames.size());
    for (std::size_t k = 0; k < count; ++k) {
        const auto& frame = frames[count == 1 ? 0 : k * (frames.size() - 1) / (count - 1)];
        char name[32], caption[64];
        std::snprintf(name, sizeof name, "_%06d.png", frame.number);
        std::snprintf(caption, sizeof caption, ", %.3f s", frame.time);
        out.push_back({experiment.name + name, experiment.name + caption});
        video::write_png(folder / out.back().file,
            draw_differences(video::read_mask(frame.mask), video::read_mask(masks / frame.mask.filename())));
    }
    return out;
}

} // namespace treacle::identify
