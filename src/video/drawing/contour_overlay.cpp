#include "video/drawing/contour_overlay.hpp"

#include <algorithm>

namespace treacle::video {

namespace {
Image even_part(const Image& frame) {
    Image out{frame.width / 2 * 2, frame.height / 2 * 2, {}};
    out.pixels.reserve(3 * std::size_t(out.width) * std::size_t(out.height));
    for (int y = 0; y < out.height; ++y)
        out.pixels.insert(out.pixels.end(), frame.at(0, y), frame.at(0, y) + 3 * out.width);
    return out;
}

bool is_edge(const Mask& mask, int x, int y) {
    return mask.liquid(x, y) &&
           (x == 0 || y == 0 || x + 1 == mask.width || y + 1 == mask.height || !mask.liquid(x - 1, y) ||
               !mask.liquid(x + 1, y) || !mask.liquid(x, y - 1) || !mask.liquid(x, y + 1));
}

void draw_edges(Image& image, const Mask& mask, const Rgb8& colour) {
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            if (is_edge(mask, x, y))
                std::ranges::copy(colour, image.pixels.begin() + 3 * (std::ptrdiff_t(y) * image.width + x));
}

void darken_excluded(Image& image, const Mask& mask) {
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            if (mask.at(x, y) != mask_excluded) continue;
            auto* pixel = image.pixels.data() + 3 * (std::size_t(y) * std::size_t(image.width) + std::size_t(x));
            for (int c = 0; c < 3; ++c) pixel[c] = std::uint8_t(pixel[c] / 2);
        }
}
} // namespace

Image draw_contour(const Image& frame, const Mask& mask) {
    auto out = even_part(frame);
    darken_excluded(out, mask);
    draw_edges(out, mask, {255, 0, 0});
    return out;
}

Image draw_contours(const Image& frame, const Mask& observed, const Mask& simulated) {
    auto out = even_part(frame);
    darken_excluded(out, observed);
    draw_edges(out, observed, observed_colour);
    draw_edges(out, simulated, simulated_colour);
    return out;
}

} // namespace treacle::video
