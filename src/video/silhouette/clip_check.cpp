#include "video/silhouette/clip_check.hpp"

#include "base/median.hpp"
#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/clip/usable_clip.hpp"
#include "video/mask/pixels.hpp"
#include "video/silhouette/brightness.hpp"
#include "video/silhouette/contour_refinement.hpp"
#include "video/silhouette/empty_scene.hpp"
#include "video/silhouette/mask_cleaning.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {
constexpr float changed_block = 7; // [grey levels of 255], of blocks of 4 x 4 pixels
constexpr int least_blocks = 4;

std::string text_of(double value, int digits) {
    const double unit = std::pow(10.0, digits);
    return format_number(std::round(value * unit) / unit);
}

cv::Mat blocks_of(const Image& image) {
    cv::Mat grey, small;
    cv::cvtColor(pixels_of(image), grey, cv::COLOR_RGB2GRAY);
    cv::resize(grey, small, {}, 0.25, 0.25, cv::INTER_AREA);
    small.convertTo(small, CV_32F);
    return small;
}

// Noise by the difference of two frames at rest.
double noise_of(const Image& a, const Image& b) {
    std::vector<float> sizes;
    for (std::size_t i = 1; i < a.pixels.size(); i += 3 * 7) // green
        sizes.push_back(std::abs(float(a.pixels[i]) - float(b.pixels[i])));
    // The median of whole numbers is coarse: the mean of a normal distribution's sizes is 0.798 of its deviation.
    double sum = 0;
    const double cut = 6 * std::max(1.0, upper_median(sizes));
    std::size_t count = 0;
    for (const float size : sizes)
        if (size <= cut) sum += size, ++count;
    return count > 0 ? sum / double(count) / 0.7979 / std::sqrt(2.0) : 0;
}

// Everything that is gathered in one pass over the frames.
struct Survey {
    ClipCheck& check;
    Registration registration;
    FrameShift shift;
    Image first, before, most;
    std::vector<float> first_light;
    cv::Mat first_blocks, before_blocks;
    std::vector<double> steps, gains;
    int most_blocks = 0;

    void begin(const Image& image) {
        registration = Registration(image, {});
        check.registered = registration.possible();
        first = before = image;
        first_light.assign(image.pixels.begin(), image.pixels.end());
        first_blocks = before_blocks = blocks_of(image);
        std::size_t white = 0;
        for (std::size_t i = 1; i < image.pixels.size(); i += 3) white += image.pixels[i] >= 252 ? 1 : 0;
        const std::size_t pixels = image.pixels.size() / 3;
        check.clipped = double(white) / double(pixels);
        steps.push_back(0);
        gains.push_back(1);
    }

    void add(const TimedFrame& frame) {
        if (frame.index == 1) check.noise = noise_of(first, frame.image);
        const cv::Mat stored = blocks_of(frame.image);
        steps.push_back(cv::mean(cv::abs(stored - before_blocks))[0]);
        before_blocks = stored;
        Image image = frame.image;
        if (registration.possible()) follow(frame.index, image);
        const auto matched = match_brightness(image, first_light, {});
        gains.push_back(matched.gain);
        check.brightness_low = std::min(check.brightness_low, matched.gain);
        check.brightness_high = std::max(check.brightness_high, matched.gain);
        const int changed = cv::countNonZero(cv::abs(blocks_of(matched.image) - first_blocks) > changed_block);
        if (changed >= least_blocks && !check.first_change) check.first_change = frame.index;
        if (changed <= most_blocks) return;
        most_blocks = changed;
        most = matched.image;
    }

    void follow(std::int64_t index, Image& image) {
        shift = follow_shift(registration, image, shift);
        const double moved = shift.largest(image.width, image.height);
        if (moved > check.largest_shift) check.largest_shift = moved, check.shifted = index;
        if (shift.changed > check.largest_changed) check.largest_changed = shift.changed, check.changed = index;
        image = undo_shift(image, shift);
    }

    void finish() {
        check.moving_area = double(most_blocks) / double(first_blocks.total());
        double squares = 0;
        for (std::size_t k = 1; k < gains.size(); ++k) squares += std::pow(gains[k] - gains[k - 1], 2);
        check.flicker = gains.size() > 1 ? std::sqrt(squares / double(gains.size() - 1)) : 0;
        // A codec repeats frames of a scene at rest: only between frames that move does one stand out.
        for (std::size_t k = 2; k + 1 < steps.size(); ++k)
            if (std::min(steps[k - 1], steps[k + 1]) > 0.05 && steps[k] < 0.15 * std::min(steps[k - 1], steps[k + 1]))
                check.doubled.push_back(std::int64_t(k));
        if (most_blocks >= least_blocks) measure_contour();
    }

    // Measures the contour of what differs most from the first frame.
    void measure_contour() {
        cv::Mat grey, grey_first;
        cv::cvtColor(pixels_of(most), grey, cv::COLOR_RGB2GRAY);
        cv::cvtColor(pixels_of(first), grey_first, cv::COLOR_RGB2GRAY);
        cv::Mat difference;
        cv::absdiff(grey, grey_first, difference);
        auto mask = mask_of(difference > std::max(10.0, 5 * check.noise));
        SilhouetteSettings settings;
        clean_mask(mask, settings, {});
        if (mask.area() < 200) return;
        const auto refined = refine_contour(most, first_light, mask, MixingSpace::code, 0);
        check.contrast = 255 * refined.contrast / std::sqrt(3.0);
        check.edge_width = refined.edge_width;
    }
};

std::int64_t count_dropped(const ClipInfo& info) {
    const double usual = info.median_interval();
    std::int64_t dropped = 0, regular = 0;
    for (std::size_t k = 1; k < info.stamps.size(); ++k) {
        const double ratio = (info.stamps[k] - info.stamps[k - 1]) / usual;
        if (std::abs(ratio - 1) < 0.1) ++regular;
        if (ratio > 1.6 && std::abs(ratio - std::round(ratio)) < 0.15) dropped += std::llround(ratio) - 1;
    }
    // No frame is missing where the rate is variable by nature.
    return 10 * regular >= 7 * (std::ssize(info.stamps) - 1) ? dropped : 0;
}

void judge_motion(ClipCheck& check, const SilhouetteSettings& limits) {
    auto& out = check.findings;
    if (check.registered && check.largest_changed > limits.max_changed)
        out.push_back({FindingKind::problem,
            "the camera moves: " + text_of(100 * check.largest_changed, 0) +
                " % of the background has changed in frame " + std::to_string(check.changed),
            "film from a stand, or cut the clip there"});
    else if (check.registered && check.largest_shift > limits.max_shift)
        out.push_back({FindingKind::problem,
            "the camera moves: by " + text_of(check.largest_shift, 1) + " px in frame " + std::to_string(check.shifted),
            "film from a stand, or cut the clip there"});
    else if (check.registered && check.largest_shift > 0.3)
        out.push_back({FindingKind::warning,
            "the camera drifts by up to " + text_of(check.largest_shift, 2) + " px (frame " +
                std::to_string(check.shifted) + ")",
            "silhouettes registers frames onto the first; a heavier stand is better"});
    if (!check.registered)
        out.push_back({FindingKind::note, "the background has too little texture to tell whether the camera moves",
            "put something with edges at the rim of the picture"});
    if (!check.first_change)
        out.push_back({FindingKind::problem, "nothing moves in it: no frame differs from the first one",
            "choose the clip with the experiment"});
    else if (*check.first_change < 5)
        out.push_back({FindingKind::warning,
            "frame " + std::to_string(*check.first_change) +
                " already differs from the first one: there is no empty scene at its start",
            "film 2 s of the empty scene first, or give silhouettes one by --empty-picture or --empty-clip"});
}

void judge_picture(ClipCheck& check) {
    auto& out = check.findings;
    if (check.brightness_high / check.brightness_low > 1.02)
        out.push_back({FindingKind::warning,
            "the exposure drifts: brightness from " + text_of(check.brightness_low, 3) + " to " +
                text_of(check.brightness_high, 3) + " of the first frame",
            "lock exposure and white balance; silhouettes takes the drift out"});
    if (check.flicker > 0.01)
        out.push_back({FindingKind::warning,
            "the light flickers by " + text_of(100 * check.flicker, 1) + " % from frame to frame",
            "light with direct current, or by daylight"});
    if (check.clipped > 0.2)
        out.push_back({FindingKind::note, text_of(100 * check.clipped, 0) + " % of the picture is white without detail",
            "expose shorter, unless it is a back light"});
    if (check.contrast > 0 && check.contrast < 30)
        out.push_back({FindingKind::warning,
            "the contour has little contrast: " + text_of(check.contrast, 1) + " grey levels of 255, noise " +
                text_of(check.noise, 1),
            "dye the liquid, light it from behind, or change the background"});
    if (check.edge_width > 2)
        out.push_back({FindingKind::warning, "the contour is blurred by " + text_of(check.edge_width, 1) + " px",
            "focus on the liquid and lock the focus; expose shorter"});
}

void judge_stamps(const ClipInfo& info, ClipCheck& check) {
    auto& out = check.findings;
    if (check.dropped > 0)
        out.push_back({FindingKind::warning, std::to_string(check.dropped) + " frames are missing by their time stamps",
            "the times of the others are kept; free the camera's memory"});
    if (!check.doubled.empty())
        out.push_back({FindingKind::warning,
            std::to_string(check.doubled.size()) + " frames repeat the one before, the first of them frame " +
                std::to_string(check.doubled.front()),
            "the file was made for another rate: take the camera's own file"});
    if (info.variable_rate()) out.push_back({FindingKind::note, "the rate is variable", "times are the frames' own"});
    if (!info.stamps.empty() && info.stamps.front() != 0)
        out.push_back({FindingKind::note, "the first time stamp is " + text_of(info.stamps.front(), 6) + " s", ""});
    if (info.rate() > 0 && info.rate() < 20)
        out.push_back({FindingKind::note, "the rate is low: " + text_of(info.rate(), 2) + " Hz",
            "30 Hz or more shows when the flow starts"});
    if (!info.orientation.upright())
        out.push_back({FindingKind::note,
            "frames are stored turned; the container turns them by " + std::to_string(info.orientation.degrees()) +
                " degrees",
            ""});
    if (!info.damage.empty())
        out.push_back(
            {FindingKind::problem, "is cut off: " + info.damage, "copy it again; --allow-damage takes what is there"});
}
} // namespace

bool ClipCheck::usable() const {
    return std::ranges::none_of(findings, [](const Finding& f) { return f.kind == FindingKind::problem; });
}

ClipCheck check_clip(FrameSource& source, const std::function<void(std::int64_t, std::int64_t)>& progress) {
    cv::setNumThreads(1);
    ClipCheck check;
    Survey survey{check, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, 0};
    source.rewind();
    for (TimedFrame frame; source.read(frame);) {
        if (frame.index == 0)
            survey.begin(frame.image);
        else
            survey.add(frame);
        progress(frame.index + 1, std::ssize(source.info().stamps));
    }
    survey.finish();
    const auto& info = source.info();
    check.dropped = count_dropped(info);
    for (const auto& unusable : reasons_against(info))
        check.findings.push_back({FindingKind::problem, unusable.problem + "; " + unusable.reason, unusable.cure});
    judge_stamps(info, check);
    judge_motion(check, SilhouetteSettings{});
    judge_picture(check);
    std::ranges::stable_sort(check.findings, {}, &Finding::kind);
    return check;
}

} // namespace treacle::video
