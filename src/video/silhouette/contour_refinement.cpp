#include "video/silhouette/contour_refinement.hpp"

#include "base/median.hpp"
#include "video/film/film_look.hpp"
#include "video/mask/pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {
constexpr int scale = 4;          // of the small pictures in which means are taken
constexpr float seldom = 1e-3F;   // weight of pixels at the contour, where no others are near
constexpr double first_width = 2; // [px]

cv::Mat to_light(const cv::Mat& rgb, MixingSpace mixing) {
    cv::Mat table(1, 256, CV_32F), light(rgb.size(), CV_32FC3);
    for (int v = 0; v < 256; ++v)
        table.at<float>(v) = mixing == MixingSpace::code ? float(v) / 255 : float(light_of_code(v / 255.0));
    for (int y = 0; y < rgb.rows; ++y) {
        const auto* in = rgb.ptr<std::uint8_t>(y);
        auto* out = light.ptr<float>(y);
        for (int i = 0; i < 3 * rgb.cols; ++i) out[i] = table.at<float>(in[i]);
    }
    return light;
}

cv::Mat mean_to_light(const std::vector<float>& background, int width, const cv::Rect& box, MixingSpace mixing) {
    cv::Mat light(box.size(), CV_32FC3);
    for (int y = 0; y < box.height; ++y) {
        const auto* in = background.data() + 3 * (std::size_t(box.y + y) * std::size_t(width) + std::size_t(box.x));
        auto* out = light.ptr<float>(y);
        for (int i = 0; i < 3 * box.width; ++i)
            out[i] = mixing == MixingSpace::code ? in[i] / 255 : float(light_of_code(double(in[i]) / 255));
    }
    return light;
}

cv::Mat smaller(const cv::Mat& picture) {
    cv::Mat out;
    cv::resize(
        picture, out, {(picture.cols + scale - 1) / scale, (picture.rows + scale - 1) / scale}, 0, 0, cv::INTER_AREA);
    return out;
}

// Weighted local sums: two radii, the far one where the near one has no weight.
cv::Mat local_sum(const cv::Mat& picture, double radius) {
    cv::Mat near, far;
    const double s = radius / scale;
    const auto size = [](double sigma) { return 2 * int(std::ceil(2.5 * sigma)) + 1; };
    cv::GaussianBlur(picture, near, {size(s), size(s)}, s, s, cv::BORDER_CONSTANT);
    cv::GaussianBlur(picture, far, {size(4 * s), size(4 * s)}, 4 * s, 4 * s, cv::BORDER_CONSTANT);
    return near + 1e-3 * far;
}

cv::Mat times(const cv::Mat& picture, const cv::Mat& weight) {
    cv::Mat planes[3] = {weight, weight, weight}, all;
    cv::merge(planes, 3, all);
    return picture.mul(all);
}

cv::Mat larger(const cv::Mat& picture, const cv::Size& size) {
    cv::Mat out;
    cv::resize(picture, out, size, 0, 0, cv::INTER_LINEAR);
    return out;
}

// Value at each pixel of a straight line through the weighted values near it: liquid is shaded, and its means stand for
// positions further in. Slopes of few pixels count less; none changes a value by more than 30 %.
cv::Mat local_line(const cv::Mat& picture, const cv::Mat& weight, double radius, const cv::Mat& mean) {
    const double s = radius / scale;
    const int size = 2 * int(std::ceil(2.5 * s)) + 1;
    const auto blurred = [&](const cv::Mat& values) {
        cv::Mat out;
        cv::GaussianBlur(values, out, {size, size}, s, s, cv::BORDER_CONSTANT);
        return out;
    };
    cv::Mat x(weight.size(), CV_32F), y(weight.size(), CV_32F);
    for (int j = 0; j < x.rows; ++j)
        for (int i = 0; i < x.cols; ++i) {
            x.at<float>(j, i) = float(i) - float(x.cols) / 2;
            y.at<float>(j, i) = float(j) - float(x.rows) / 2;
        }
    const cv::Mat wx = weight.mul(x), wy = weight.mul(y);
    const cv::Mat s0 = blurred(weight), sx = blurred(wx), sy = blurred(wy), sxx = blurred(wx.mul(x)),
                  sxy = blurred(wx.mul(y)), syy = blurred(wy.mul(y));
    const cv::Mat t0 = blurred(times(picture, weight)), tx = blurred(times(picture, wx)),
                  ty = blurred(times(picture, wy));
    cv::Mat line = mean.clone();
    for (int j = 0; j < x.rows; ++j)
        for (int i = 0; i < x.cols; ++i) {
            const double n = double(s0.at<float>(j, i));
            if (n < 1e-3) continue;
            const double px = double(x.at<float>(j, i)), py = double(y.at<float>(j, i));
            const double mx = double(sx.at<float>(j, i)) / n, my = double(sy.at<float>(j, i)) / n, ridge = 0.15 * s * s;
            const double cxx = double(sxx.at<float>(j, i)) / n - mx * mx + ridge,
                         cxy = double(sxy.at<float>(j, i)) / n - mx * my;
            const double cyy = double(syy.at<float>(j, i)) / n - my * my + ridge, determinant = cxx * cyy - cxy * cxy;
            if (!(determinant > 0)) continue;
            for (int c = 0; c < 3; ++c) {
                const double m = double(t0.at<cv::Vec3f>(j, i)[c]) / n;
                const double fx = double(tx.at<cv::Vec3f>(j, i)[c]) / n - m * mx,
                             fy = double(ty.at<cv::Vec3f>(j, i)[c]) / n - m * my;
                const double gx = (cyy * fx - cxy * fy) / determinant, gy = (cxx * fy - cxy * fx) / determinant;
                line.at<cv::Vec3f>(j, i)[c] = float(std::clamp(m + gx * (px - mx) + gy * (py - my), 0.7 * m, 1.3 * m));
            }
        }
    return line;
}

// Weight of pixels by their distance from the contour: none within the blur.
cv::Mat weights(const cv::Mat& inside, double blurred) {
    cv::Mat distance;
    cv::distanceTransform(inside, distance, cv::DIST_L2, cv::DIST_MASK_5);
    cv::Mat weight(inside.size(), CV_32F);
    for (int y = 0; y < inside.rows; ++y)
        for (int x = 0; x < inside.cols; ++x) {
            const float d = distance.at<float>(y, x);
            const float t = std::clamp((d - float(blurred)) / 2 + 1, 0.0F, 1.0F);
            weight.at<float>(y, x) = d > 0 ? std::max(t, seldom * d / float(blurred)) : 0;
        }
    return weight;
}

struct Levels {
    cv::Mat light, liquid, background; // CV_32FC3
};

Levels local_levels(
    const cv::Mat& light, const cv::Mat& empty, const cv::Mat& liquid, const cv::Mat& excluded, double width) {
    const double blurred = 2.5 * width + 1, radius = std::max(6.0, 1.5 * blurred);
    cv::Mat inside = weights(liquid, blurred), outside = weights(liquid == 0, blurred);
    inside.setTo(0, excluded);
    outside.setTo(0, excluded);
    Levels levels;
    levels.light = light;
    const auto mean = [&](const cv::Mat& above, const cv::Mat& below) {
        cv::Mat ratio;
        cv::divide(local_sum(above, radius), local_sum(below, radius) + cv::Scalar::all(1e-9), ratio);
        return ratio;
    };
    const cv::Mat ones(light.size(), CV_32FC3, cv::Scalar::all(1));
    const cv::Mat weight = smaller(inside), weighted = smaller(times(light, inside)),
                  all = smaller(times(ones, inside));
    cv::Mat values;
    cv::divide(weighted, all + cv::Scalar::all(1e-9), values);
    levels.liquid = larger(local_line(values, weight, radius, mean(weighted, all)), light.size());
    levels.background =
        larger(mean(smaller(times(light, outside)), smaller(times(empty, outside))), light.size()).mul(empty);
    return levels;
}

// Fraction of liquid of each pixel within `band` of the contour of `liquid`, and `known` where it could be determined.
struct LiquidFractions {
    cv::Mat fraction, known;
};

LiquidFractions solve_fractions(const Levels& levels, const cv::Mat& liquid, double band) {
    cv::Mat outside, inside;
    cv::distanceTransform(liquid == 0, outside, cv::DIST_L2, cv::DIST_MASK_5);
    cv::distanceTransform(liquid, inside, cv::DIST_L2, cv::DIST_MASK_5);
    LiquidFractions fractions;
    liquid.convertTo(fractions.fraction, CV_32F, 1 / 255.0);
    fractions.known = cv::Mat::zeros(liquid.size(), CV_8U);
    for (int y = 0; y < liquid.rows; ++y) {
        const auto* in = levels.light.ptr<float>(y);
        const auto* f = levels.liquid.ptr<float>(y);
        const auto* b = levels.background.ptr<float>(y);
        for (int x = 0; x < liquid.cols; ++x) {
            if (outside.at<float>(y, x) > float(band) || inside.at<float>(y, x) > float(band)) continue;
            float product = 0, square = 0;
            for (int c = 3 * x; c < 3 * x + 3; ++c) {
                product += (in[c] - b[c]) * (f[c] - b[c]);
                square += (f[c] - b[c]) * (f[c] - b[c]);
            }
            if (square < 4e-4F) continue; // no contrast
            fractions.fraction.at<float>(y, x) = std::clamp(product / square, -1.0F, 2.0F);
            fractions.known.at<std::uint8_t>(y, x) = 255;
        }
    }
    return fractions;
}

// Blur spreads as heat does: after sigma^2 / 2 a bent contour has moved by sigma^2 / 2 times its curvature. Takes that
// back by one step of the part along the contour, curvature times gradient; the part across it leaves half height alone.
void straighten(cv::Mat& fraction, double width) {
    cv::Mat smooth;
    const double more = 0.5 * width;
    cv::GaussianBlur(fraction, smooth, {}, more, more, cv::BORDER_REPLICATE);
    // The smoothing spreads the gradient too: by sqrt(1 + 1/4), taken out to first order.
    const auto step = float(0.5 * width * width * std::sqrt(1.25));
    for (int y = 1; y + 1 < fraction.rows; ++y) {
        const float *up = smooth.ptr<float>(y - 1), *row = smooth.ptr<float>(y), *down = smooth.ptr<float>(y + 1);
        auto* out = fraction.ptr<float>(y);
        for (int x = 1; x + 1 < fraction.cols; ++x) {
            const float u = (row[x + 1] - row[x - 1]) / 2, v = (down[x] - up[x]) / 2;
            const float square = u * u + v * v;
            if (square < 1e-4F) continue;
            const float uu = row[x + 1] - 2 * row[x] + row[x - 1], vv = down[x] - 2 * row[x] + up[x];
            const float uv = (down[x + 1] - down[x - 1] - up[x + 1] + up[x - 1]) / 4;
            const float along = (uu * v * v - 2 * u * v * uv + vv * u * u) / square;
            out[x] -= std::clamp(step * along, -0.25F, 0.25F);
        }
    }
}

// Width of a Gaussian blur, whose profile is 1 / (sigma sqrt(2 pi)) steep at half its height.
double width_of(const LiquidFractions& fractions) {
    std::vector<float> steep;
    for (int y = 1; y + 1 < fractions.fraction.rows; ++y)
        for (int x = 1; x + 1 < fractions.fraction.cols; ++x) {
            const float a = fractions.fraction.at<float>(y, x);
            if (fractions.known.at<std::uint8_t>(y, x) == 0 || std::abs(a - 0.5F) > 0.2F) continue;
            const float u = (fractions.fraction.at<float>(y, x + 1) - fractions.fraction.at<float>(y, x - 1)) / 2;
            const float v = (fractions.fraction.at<float>(y + 1, x) - fractions.fraction.at<float>(y - 1, x)) / 2;
            steep.push_back(std::hypot(u, v));
        }
    if (steep.size() < 20) return 0;
    return std::clamp(0.39894 / std::max(1e-3, upper_median(steep)), 0.5, 12.0);
}

cv::Rect box_of(const cv::Mat& liquid, int margin) {
    const cv::Rect box = cv::boundingRect(liquid);
    if (box.empty()) return {};
    return cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
           cv::Rect({0, 0}, liquid.size());
}

constexpr double bin = 0.25;                              // of profiles, in blur widths
constexpr double profile_extent = 3.2, even_extent = 2.6; // in blur widths

float sample(const cv::Mat& field, double x, double y) {
    const int i = int(x), j = int(y);
    const auto u = float(x - i), v = float(y - j);
    const float *a = field.ptr<float>(j) + i, *b = field.ptr<float>(j + 1) + i;
    return (1 - v) * ((1 - u) * a[0] + u * a[1]) + v * ((1 - u) * b[0] + u * b[1]);
}

// Mean fraction along the normals of the contour, through where it is 1/2 between two pixels; empty for a short contour.
std::vector<double> profile_of(const cv::Mat& fraction, double width) {
    cv::Mat smooth;
    const double spread = std::max(0.8, 0.5 * width);
    cv::GaussianBlur(fraction, smooth, {}, spread, spread, cv::BORDER_REPLICATE);
    const int half = int(profile_extent / bin);
    const double margin = profile_extent * width + 2;
    std::vector<double> sum(std::size_t(2 * half + 1), 0);
    std::size_t count = 0;
    const auto cross = [&](int x, int y, int dx, int dy) {
        const float here = fraction.at<float>(y, x), there = fraction.at<float>(y + dy, x + dx);
        if ((here >= 0.5F) == (there >= 0.5F)) return;
        const double part = double((here - 0.5F) / (here - there));
        const double px = x + part * dx, py = y + part * dy;
        if (px < margin || py < margin || px > fraction.cols - 1 - margin || py > fraction.rows - 1 - margin) return;
        double nx = double(sample(smooth, px - 1, py) - sample(smooth, px + 1, py)),
               ny = double(sample(smooth, px, py - 1) - sample(smooth, px, py + 1));
        const double length = std::hypot(nx, ny);
        if (length < 1e-3 || std::abs(dx != 0 ? nx : ny) < 0.7 * length)
            return; // each point once, along its steeper axis
        nx /= length, ny /= length;
        for (int k = -half; k <= half; ++k)
            sum[std::size_t(k + half)] +=
                double(sample(fraction, px + k * bin * width * nx, py + k * bin * width * ny));
        ++count;
    };
    for (int y = 0; y + 1 < fraction.rows; ++y)
        for (int x = 0; x + 1 < fraction.cols; ++x) {
            cross(x, y, 1, 0);
            cross(x, y, 0, 1);
        }
    if (count < 100) return {};
    for (auto& value : sum) value /= double(count);
    return sum;
}

// Root mean square of the even part of a profile about its best middle: 0 for any even blur, whatever its levels are.
double even_part(const std::vector<double>& profile) {
    const double middle = double(profile.size() - 1) / 2;
    const auto at = [&](double k) {
        const auto i = static_cast<std::size_t>(std::clamp(k, 0.0, double(profile.size() - 2)));
        return profile[i] + (k - double(i)) * (profile[i + 1] - profile[i]);
    };
    double best = 1;
    for (double m = -0.6; m <= 0.6; m += 0.01) {
        double sum = 0, squares = 0, n = 0;
        for (double s = 0; s <= even_extent; s += bin) {
            const double even = at(middle + (m + s) / bin) + at(middle + (m - s) / bin);
            sum += even;
            squares += even * even;
            ++n;
        }
        best = std::min(best, std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n))));
    }
    return best;
}

struct Solved {
    cv::Mat liquid;
    LiquidFractions fractions;
    Levels levels;
    cv::Mat empty; // CV_32FC3
    double width = 0;
};

// A frame of a film, the mean of its background, and the mask that is refined.
struct Filmed {
    const Image& frame;
    const std::vector<float>& background;
    const Mask& rough;
};

// `width`: of the blur to start from, 0: not known [px].
Solved iterate(const Filmed& filmed, const cv::Rect& box, MixingSpace mixing, double width, int rounds) {
    const auto& [frame, background, rough] = filmed;
    const cv::Mat light = to_light(pixels_of(frame)(box), mixing);
    const cv::Mat empty = background.empty() ? cv::Mat(box.size(), CV_32FC3, cv::Scalar::all(1))
                                             : mean_to_light(background, frame.width, box, mixing);
    const cv::Mat excluded = pixels_of(rough)(box) == mask_excluded;
    Solved solved;
    solved.liquid = pixels_of(rough)(box) == mask_liquid;
    solved.empty = empty;
    solved.width = width > 0 ? width : first_width;
    for (int round = 0; round < rounds; ++round) {
        const double band = std::max(8.0, 3 * solved.width + 3);
        solved.levels = local_levels(light, empty, solved.liquid, excluded, solved.width);
        solved.fractions = solve_fractions(solved.levels, solved.liquid, band);
        // Noise a pixel wide would fray a blurred contour; an even filter does not move it.
        const double smooth = std::min(1.5, 0.35 * solved.width);
        cv::GaussianBlur(
            solved.fractions.fraction, solved.fractions.fraction, {9, 9}, smooth, smooth, cv::BORDER_REPLICATE);
        if (solved.width > 1.5) straighten(solved.fractions.fraction, solved.width);
        cv::Mat next = solved.fractions.fraction >= 0.5F;
        solved.liquid.copyTo(next, solved.fractions.known == 0);
        solved.liquid = next;
        if (const double measured = width_of(solved.fractions); measured > 0) solved.width = measured;
    }
    solved.liquid.setTo(0, excluded);
    return solved;
}

// Against the empty scene at the brightness that the background has along the contour.
void measure_contrast(const Solved& solved, RefinedContour& refined) {
    std::vector<float> clear, gains[3];
    for (int y = 0; y < solved.liquid.rows; y += 2)
        for (int x = 0; x < solved.liquid.cols; x += 2) {
            if (solved.fractions.known.at<std::uint8_t>(y, x) == 0) continue;
            const auto b = solved.levels.background.at<cv::Vec3f>(y, x), e = solved.empty.at<cv::Vec3f>(y, x);
            for (int c = 0; c < 3; ++c)
                if (e[c] > 1e-3F) gains[c].push_back(b[c] / e[c]);
        }
    const cv::Vec3f gain(float(upper_median(gains[0])), float(upper_median(gains[1])), float(upper_median(gains[2])));
    const auto clearness = [&](int y, int x) {
        return float(cv::norm(solved.levels.light.at<cv::Vec3f>(y, x) - solved.empty.at<cv::Vec3f>(y, x).mul(gain)));
    };
    for (int y = 0; y < solved.liquid.rows; ++y)
        for (int x = 0; x < solved.liquid.cols; ++x)
            if (solved.liquid.at<std::uint8_t>(y, x) != 0) clear.push_back(clearness(y, x));
    auto sorted = clear;
    refined.contrast = upper_median(sorted);
    for (const float value : clear) refined.faint += value < refined.contrast / 3 ? 1 : 0;
}
} // namespace

RefinedContour refine_contour(const Image& frame, const std::vector<float>& background, const Mask& rough,
    MixingSpace mixing, double edge_width) {
    RefinedContour refined{rough, 0, 0, 0};
    const auto box = box_of(pixels_of(rough) == mask_liquid, 48);
    if (box.empty()) return refined;
    const auto solved = iterate({frame, background, rough}, box, mixing, edge_width, edge_width > 0 ? 2 : 3);
    cv::Mat out = pixels_of(refined.mask)(box);
    out.setTo(mask_background, out == mask_liquid);
    out.setTo(mask_liquid, solved.liquid);
    refined.edge_width = width_of(solved.fractions);
    measure_contrast(solved, refined);
    return refined;
}

Unevenness measure_unevenness(const Image& frame, const std::vector<float>& background, const Mask& rough) {
    Unevenness found;
    const auto box = box_of(pixels_of(rough) == mask_liquid, 48);
    if (box.empty()) return found;
    for (const auto mixing : {MixingSpace::light, MixingSpace::code}) {
        const auto solved = iterate({frame, background, rough}, box, mixing, 0, 3);
        const auto fractions = solve_fractions(solved.levels, solved.liquid, 5 * solved.width + 6).fraction;
        const auto profile = profile_of(fractions, solved.width);
        if (profile.empty()) return {};
        (mixing == MixingSpace::light ? found.light : found.code) = even_part(profile);
    }
    return found;
}

} // namespace treacle::video
