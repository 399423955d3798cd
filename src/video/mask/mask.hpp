#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace treacle::video {

// Values of a silhouette's pixels. A pixel belongs to the liquid when its centre does.
inline constexpr std::uint8_t mask_background = 0, mask_excluded = 64, mask_liquid = 255;

// Silhouette of liquid in one picture.
struct Mask {
    int width = 0, height = 0;        // [pixels]
    std::vector<std::uint8_t> pixels; // [height][width], top row first

    // Value of a pixel, one of the mask_ constants; no check of the range.
    std::uint8_t at(int column, int row) const {
        return pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(column)];
    }
    bool liquid(int column, int row) const { return at(column, row) == mask_liquid; } // false for excluded pixels
    std::size_t area() const;                                                         // of liquid [px]
};

// The file of a frame's mask in a folder of masks: mask_000012.png.
std::string mask_name(std::int64_t frame);

// Grey PNG, written as a whole. SimulationError as write_png().
void write_mask(const std::filesystem::path& path, const Mask& mask);
// Any picture; its grey levels. InputError when it cannot be read.
Mask read_mask(const std::filesystem::path& path);

// Displacement of a mask's contour from that of the exact one [px], positive where it is too large. By pixels' edges:
// each edge between liquid and background of `mask` is at a signed distance from the exact contour, which lies half way
// between pixel centres too. Pixels excluded in either, and their neighbours, do not count.
struct ContourError {
    double mean = 0, deviation = 0, largest = 0; // [px]
    double mean_by_area = 0;                     // (A - A_exact) / length of the exact contour
    std::size_t edges = 0;
    double overlap = 0; // intersection over union
};
ContourError compare_contours(const Mask& mask, const Mask& exact);

} // namespace treacle::video
