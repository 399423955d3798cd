#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace treacle::video {

// A picture, 8 bit sRGB.
struct Image {
    int width = 0, height = 0;        // [pixels]
    std::vector<std::uint8_t> pixels; // [height][width][3], red first, top row first

    // Red of a pixel; green and blue follow. No check of the range.
    const std::uint8_t* at(int column, int row) const {
        return pixels.data() + 3 * (static_cast<std::size_t>(row) * width + column);
    }
};

} // namespace treacle::video
