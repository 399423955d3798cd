#include "video/drawing/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {
constexpr int fine = 4; // text is drawn this many times larger and averaged: smoother than the font's own lines

enum class Align { left, centre, right };

struct Text {
    std::string content;
    double x, y;   // [pixels] of the baseline's left end, centre or right end
    double height; // of capitals [pixels]
    Align align = Align::left;
};

void blend(Image& image, const cv::Mat& mask, int left, int top, const Rgb8& ink) {
    for (int row = 0; row < mask.rows; ++row)
        for (int column = 0; column < mask.cols; ++column) {
            const int x = left + column, y = top + row;
            if (x < 0 || y < 0 || x >= image.width || y >= image.height) continue;
            const int cover = mask.at<std::uint8_t>(row, column);
            auto* pixel = image.pixels.data() + 3 * (std::size_t(y) * image.width + x);
            for (int k = 0; k < 3; ++k)
                pixel[k] = std::uint8_t((pixel[k] * (255 - cover) + ink[k] * cover + 127) / 255);
        }
}

void draw_text(Image& image, const Text& text, const Rgb8& ink) {
    cv::setNumThreads(1);
    constexpr double capital = 21; // height of the font's capitals at scale 1
    const double scale = fine * text.height / capital;
    const int thickness = std::max(1, int(std::lround(fine * text.height * 0.125)));
    int below = 0;
    const auto size = cv::getTextSize(text.content, cv::FONT_HERSHEY_SIMPLEX, scale, thickness, &below);
    const int pad = 2 * fine, width = (size.width + 2 * pad) / fine + 1;
    const int above = (size.height + pad) / fine + 1, under = (below + pad) / fine + 1;
    cv::Mat large = cv::Mat::zeros((above + under) * fine, width * fine, CV_8U), mask;
    cv::putText(large, text.content, {pad, above * fine}, cv::FONT_HERSHEY_SIMPLEX, scale, 255, thickness, cv::LINE_AA);
    cv::resize(large, mask, {width, above + under}, 0, 0, cv::INTER_AREA);
    const double fraction = text.align == Align::left ? 0 : text.align == Align::centre ? 0.5 : 1;
    const int left = int(std::lround(text.x - fraction * size.width / fine)) - pad / fine;
    blend(image, mask, left, int(std::lround(text.y)) - above, ink);
}

void fill(Image& image, const cv::Rect& box, const Rgb8& ink) {
    blend(image, cv::Mat(box.size(), CV_8U, cv::Scalar(255)), box.x, box.y, ink);
}

// All ticks with the same number of decimals, or all in powers of ten.
std::string tick_label(double value, double step) {
    char label[32];
    const int decimals = std::max(0, int(-std::floor(std::log10(step) + 1e-9)));
    if (decimals > 4 || std::abs(value) >= 1e6)
        std::snprintf(label, sizeof label, "%.3g", value);
    else
        std::snprintf(label, sizeof label, "%.*f", decimals, value);
    return label;
}

// A pointed end of the bar: above its edge, direction -1, or below it, 1.
struct PointedEnd {
    int left, width, edge, direction;
};

void draw_point(Image& image, const PointedEnd& end, const Rgb8& colour) {
    const auto& [left, width, edge, direction] = end;
    const int height = width / 2 + 1;
    cv::Mat large = cv::Mat::zeros(height * fine, width * fine, CV_8U), mask;
    const int base = direction < 0 ? large.rows : 0, tip = large.rows - base;
    const std::vector<cv::Point> corners{{0, base}, {large.cols, base}, {large.cols / 2, tip}};
    cv::fillConvexPoly(large, corners, 255, cv::LINE_AA);
    cv::resize(large, mask, {width, height}, 0, 0, cv::INTER_AREA);
    blend(image, mask, left, direction < 0 ? edge - height : edge, colour);
}
} // namespace

void draw_colour_bar(Image& image, const Legend& legend, const Rgb8& ink) {
    const double unit = image.height / 720.0;
    const int width = std::max(2, int(18 * unit)), height = std::max(4, int(300 * unit));
    const int left = image.width - int(92 * unit), top = (image.height - height) / 2;
    for (int row = 0; row < height; ++row)
        fill(image, {left, top + row, width, 1}, colour_of(legend.map, 1 - (row + 0.5) / height));
    if (legend.has_higher) draw_point(image, {left, width, top, -1}, colour_of(legend.map, 1));
    if (legend.has_lower) draw_point(image, {left, width, top + height, 1}, colour_of(legend.map, 0));

    const auto ticks = nice_ticks(legend.range);
    const double step = ticks.size() > 1 ? ticks[1] - ticks[0] : std::max(std::abs(ticks.at(0)), 1e-3);
    for (const double tick : ticks) {
        const double t = (tick - legend.range.low) / (legend.range.high - legend.range.low);
        const int y = top + int(std::lround((1 - t) * (height - 1)));
        fill(image, {left + width, y, std::max(2, int(5 * unit)), std::max(1, int(std::lround(unit)))}, ink);
        draw_text(image, {tick_label(tick, step), left + width + 9 * unit, y + 5 * unit, 10 * unit}, ink);
    }
    draw_text(image, {legend.title, image.width - 16 * unit, top - 24 * unit, 11 * unit, Align::right}, ink);
}

void draw_words(Image& image, const std::string& words, int left, int baseline, int height, const Rgb8& ink) {
    draw_text(image, {words, double(left), double(baseline), double(height)}, ink);
}

void draw_caption(Image& image, const std::string& caption, const Rgb8& ink) {
    const double unit = image.height / 720.0;
    draw_text(image, {caption, 20 * unit, image.height - 20 * unit, 12 * unit}, ink);
}

} // namespace treacle::video
