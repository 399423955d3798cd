#include "video/contour_overlay.hpp"

#include <algorithm>

namespace treacle::video {

Image draw_contour(const Image& frame, const Mask& mask) {
    Image out{frame.width / 2 * 2, frame.height / 2 * 2, {}};
    out.pixels.resize(3 * std::size_t(out.width) * std::size_t(out.height));
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            auto* pixel = out.pixels.data() + 3 * (std::size_t(y) * std::size_t(out.width) + std::size_t(x));
            std::copy_n(frame.at(x, y), 3, pixel);
            if (mask.at(x, y) == mask_excluded)
                for (int c = 0; c < 3; ++c) pixel[c] = std::uint8_t(pixel[c] / 2);
            const bool inside = mask.liquid(x, y);
            const bool edge = inside && (x == 0 || y == 0 || x + 1 == mask.width || y + 1 == mask.height || !mask.liquid(x - 1, y) ||
                                         !mask.liquid(x + 1, y) || !mask.liquid(x, y - 1) || !mask.liquid(x, y + 1));
            if (edge) pixel[0] = 255, pixel[1] = pixel[2] = 0;
        }
    return out;
}

} // namespace treacle::video
