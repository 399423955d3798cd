#include "video/silhouette/mask_cleaning.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/mask/pixels.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>

namespace treacle::video {

namespace {
// Pixels whose centre is within the radius.
cv::Mat disc(double radius) {
    const int r = int(std::floor(radius));
    cv::Mat shape(2 * r + 1, 2 * r + 1, CV_8U);
    for (int y = -r; y <= r; ++y)
        for (int x = -r; x <= r; ++x) shape.at<std::uint8_t>(y + r, x + r) = std::hypot(x, y) <= radius + 0.3 ? 1 : 0;
    return shape;
}

// The picture's edge is no contour: liquid that it cuts stays cut there.
void morph(cv::Mat& liquid, int operation, double radius) {
    if (radius < 1) return;
    const int margin = 2 * int(radius) + 2;
    cv::Mat wide;
    cv::copyMakeBorder(liquid, wide, margin, margin, margin, margin, cv::BORDER_REPLICATE);
    cv::morphologyEx(wide, wide, operation, disc(radius));
    wide(cv::Rect(margin, margin, liquid.cols, liquid.rows)).copyTo(liquid);
}

// Background that does not reach the picture's edge, without the excluded pixels, which may hide a way out.
std::size_t fill(cv::Mat& liquid, const cv::Mat& excluded) {
    cv::Mat labels, figures, centres;
    const cv::Mat open = liquid == 0;
    const int count = cv::connectedComponentsWithStats(open, labels, figures, centres, 4);
    std::vector<bool> outside(std::size_t(count), false);
    for (int k = 1; k < count; ++k) {
        const auto* f = figures.ptr<int>(k);
        outside[std::size_t(k)] = f[cv::CC_STAT_LEFT] == 0 || f[cv::CC_STAT_TOP] == 0 ||
                                  f[cv::CC_STAT_LEFT] + f[cv::CC_STAT_WIDTH] == liquid.cols ||
                                  f[cv::CC_STAT_TOP] + f[cv::CC_STAT_HEIGHT] == liquid.rows;
    }
    for (int y = 0; y < liquid.rows; ++y)
        for (int x = 0; x < liquid.cols; ++x)
            if (excluded.at<std::uint8_t>(y, x) != 0) outside[std::size_t(labels.at<int>(y, x))] = true;
    std::size_t filled = 0;
    for (int y = 0; y < liquid.rows; ++y)
        for (int x = 0; x < liquid.cols; ++x) {
            const int label = labels.at<int>(y, x);
            if (label == 0 || outside[std::size_t(label)]) continue;
            liquid.at<std::uint8_t>(y, x) = 255;
            ++filled;
        }
    return filled;
}

void drop_specks(cv::Mat& liquid, const SilhouetteSettings& settings, const Mask& seeds, CleaningReport& report) {
    cv::Mat labels, figures, centres;
    const int count = cv::connectedComponentsWithStats(liquid, labels, figures, centres, 8);
    std::vector<bool> touches(std::size_t(count), settings.keep == KeptParts::all || seeds.pixels.empty());
    if (settings.keep == KeptParts::connected && !seeds.pixels.empty()) {
        const cv::Mat seed = pixels_of(seeds);
        for (int y = 0; y < liquid.rows; ++y)
            for (int x = 0; x < liquid.cols; ++x)
                if (seed.at<std::uint8_t>(y, x) == mask_liquid) touches[std::size_t(labels.at<int>(y, x))] = true;
    }
    std::vector<bool> kept(std::size_t(count), false);
    for (int k = 1; k < count; ++k) {
        const int area = figures.at<int>(k, cv::CC_STAT_AREA);
        kept[std::size_t(k)] = area >= settings.min_area && touches[std::size_t(k)];
        if (kept[std::size_t(k)]) {
            ++report.parts;
        } else {
            ++report.specks;
            report.dropped += std::size_t(area);
        }
    }
    for (int y = 0; y < liquid.rows; ++y)
        for (int x = 0; x < liquid.cols; ++x)
            if (!kept[std::size_t(labels.at<int>(y, x))]) liquid.at<std::uint8_t>(y, x) = 0;
}

InputError no_polygon(const std::string& text, const std::string& where) {
    return InputError(
        {where + " = " + shorten(text), "is no polygon and no picture", "a polygon has three corners at least",
            "write for instance \"100,50 400,50 400,300\", in pixels of the upright picture"});
}
} // namespace

CleaningReport clean_mask(Mask& mask, const SilhouetteSettings& settings, const Mask& seeds) {
    CleaningReport report;
    cv::Mat whole = pixels_of(mask);
    const cv::Mat excluded = whole == mask_excluded;
    cv::Mat liquid = whole == mask_liquid;
    morph(liquid, cv::MORPH_CLOSE, settings.closing);
    morph(liquid, cv::MORPH_OPEN, settings.opening);
    if (settings.fill_holes) report.filled = fill(liquid, excluded);
    liquid.setTo(0, excluded);
    drop_specks(liquid, settings, seeds, report);
    whole.setTo(mask_background, whole == mask_liquid);
    whole.setTo(mask_liquid, liquid);
    return report;
}

Mask draw_polygon(const std::string& corners, int width, int height, const std::string& where) {
    std::vector<double> x, y;
    std::istringstream words(corners);
    for (std::string word; words >> word;) {
        const auto comma = word.find(',');
        const auto u = read_number(std::string_view(word).substr(0, comma));
        const auto v =
            comma == std::string::npos ? std::nullopt : read_number(std::string_view(word).substr(comma + 1));
        if (!u || !v) throw no_polygon(corners, where);
        x.push_back(*u);
        y.push_back(*v);
    }
    if (x.size() < 3) throw no_polygon(corners, where);
    Mask mask{width, height, std::vector<std::uint8_t>(std::size_t(width) * std::size_t(height), mask_background)};
    for (int row = 0; row < height; ++row) {
        std::vector<double> crossings;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const auto j = (i + 1) % x.size();
            if ((y[i] <= row) == (y[j] <= row)) continue;
            crossings.push_back(x[i] + (row - y[i]) / (y[j] - y[i]) * (x[j] - x[i]));
        }
        std::ranges::sort(crossings);
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
            for (int column = std::max(0, int(std::ceil(crossings[i]))); column < width && column <= crossings[i + 1];
                 ++column)
                mask.pixels[std::size_t(row) * std::size_t(width) + std::size_t(column)] = mask_liquid;
    }
    return mask;
}

Mask read_region(const std::string& text, int width, int height, const std::string& where) {
    if (text.find(',') != std::string::npos && text.find_first_not_of("0123456789.,-+e \t") == std::string::npos)
        return draw_polygon(text, width, height, where);
    if (!std::filesystem::is_regular_file(text)) throw no_polygon(text, where);
    auto mask = read_mask(text);
    if (mask.width != width || mask.height != height)
        throw InputError(
            {where + " = " + text, "is " + std::to_string(mask.width) + " x " + std::to_string(mask.height) + " pixels",
                "the clip is " + std::to_string(width) + " x " + std::to_string(height),
                "give a picture of the clip's size, upright"});
    for (auto& value : mask.pixels) value = value >= 128 ? mask_liquid : mask_background;
    return mask;
}

} // namespace treacle::video
