#include "video/silhouette/silhouettes.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/mask/pixels.hpp"
#include "video/silhouette/contour_refinement.hpp"
#include "video/silhouette/empty_scene.hpp"
#include "video/silhouette/rough_mask.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {
constexpr std::size_t enough_liquid = 2000; // to determine the mixing by [px]
constexpr std::int64_t looks = 6;           // frames that determine mixing and level

struct Exclusion {
    FrameSpan span;
    Mask mask;
};

std::size_t perimeter_of(const Mask& mask) {
    std::size_t edges = 0;
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            const bool here = mask.liquid(x, y);
            if (x + 1 < mask.width && here != mask.liquid(x + 1, y)) ++edges;
            if (y + 1 < mask.height && here != mask.liquid(x, y + 1)) ++edges;
        }
    return edges;
}

std::string tenths(double value) { return format_number(std::round(10 * value) / 10); }
std::string percent(double fraction) { return tenths(100 * fraction) + " %"; }
} // namespace

struct SilhouetteMaker::State {
    FrameSource& source;
    SilhouetteSettings settings;
    std::int64_t count; // of frames
    std::vector<Exclusion> exclusions;
    std::optional<Mask> region, start;
    Registration registration;
    RoughMasks rough;
    MixingSpace mixing;
    std::vector<std::string> notes;
    FrameShift shift; // of the frame before
    double largest_shift = 0;
    double edge_width = 0;
    Mask before, first;

    State(FrameSource& frames, const SilhouetteSettings& wanted)
        : source(frames), settings(wanted), count(std::ssize(frames.info().stamps)), rough(wanted),
          mixing(wanted.mixing) {
        const int width = source.info().width, height = source.info().height;
        if (!settings.region.empty()) region = read_region(settings.region, width, height, "region");
        if (!settings.start.empty()) start = read_region(settings.start, width, height, "start");
        for (std::size_t i = 0; i < settings.exclusions.size(); ++i) {
            const auto& e = settings.exclusions[i];
            const auto where = "exclusions." + (e.name.empty() ? std::to_string(i) : e.name);
            exclusions.push_back({read_frame_span(e.frames, where + ".frames"),
                read_region(e.polygon.empty() ? e.picture : e.polygon, width, height, where)});
        }
    }

    std::string name_of(std::int64_t index) const { return source.info().file + ", frame " + std::to_string(index); }
    bool compares() const {
        return settings.method == SilhouetteMethod::gmm || settings.method == SilhouetteMethod::difference;
    }
    bool photographs() const { return settings.method != SilhouetteMethod::masks; }

    // Registered onto the first frame. InputError for a camera that moves.
    void align(TimedFrame& frame) {
        if (!registration.possible()) return;
        shift = follow_shift(registration, frame.image, shift);
        const double moved = shift.largest(frame.image.width, frame.image.height);
        if (shift.changed > settings.max_changed || moved > settings.max_shift)
            throw InputError({name_of(frame.index),
                "the camera moves: " + (shift.changed > settings.max_changed
                                               ? percent(shift.changed) + " of the background has changed"
                                               : "the background is shifted by " + tenths(moved) + " px"),
                "silhouettes need a camera that stands still",
                "film from a stand, cut the clip there, or raise max_changed or max_shift"});
        largest_shift = std::max(largest_shift, moved);
        frame.image = undo_shift(frame.image, shift);
    }

    void exclude(Mask& mask, std::int64_t index) const {
        for (const auto& e : exclusions) {
            if (!e.span.contains(index, count)) continue;
            for (std::size_t i = 0; i < mask.pixels.size(); ++i)
                if (e.mask.pixels[i] == mask_liquid) mask.pixels[i] = mask_excluded;
        }
        if (!region) return;
        for (std::size_t i = 0; i < mask.pixels.size(); ++i)
            if (region->pixels[i] != mask_liquid) mask.pixels[i] = mask_excluded;
    }

    // Parts must touch the liquid of the frame before or its start.
    Mask seeds() const {
        if (!start) return before;
        Mask both = *start;
        for (std::size_t i = 0; i < before.pixels.size(); ++i)
            if (before.pixels[i] == mask_liquid) both.pixels[i] = mask_liquid;
        return both;
    }

    RoughMask make_rough(const TimedFrame& frame) {
        auto found = rough.make(frame.image, before, name_of(frame.index));
        exclude(found.mask, frame.index);
        if (photographs()) clean_mask(found.mask, settings, seeds());
        return found;
    }

    FrameSilhouette make(const TimedFrame& frame) {
        FrameSilhouette out;
        out.index = frame.index;
        out.stamp = frame.stamp;
        out.time = frame.time;
        auto found = make_rough(frame);
        out.shadow = found.shadow;
        out.gain = found.gain;
        out.mask = std::move(found.mask);
        if (photographs() && settings.sub_pixel) {
            auto refined = refine_contour(frame.image, rough.background(), out.mask, mixing, edge_width);
            out.mask = std::move(refined.mask);
            out.edge_width = refined.edge_width;
            out.faint = refined.faint;
            out.contrast = refined.contrast;
            if (refined.edge_width > 0)
                edge_width = edge_width > 0 ? 0.7 * edge_width + 0.3 * refined.edge_width : refined.edge_width;
        }
        if (photographs()) out.cleaning = clean_mask(out.mask, settings, seeds());
        out.shift = shift;
        measure(out);
        if (first.pixels.empty()) first = out.mask;
        for (std::size_t i = 0; i < out.mask.pixels.size(); ++i)
            out.moved += (out.mask.pixels[i] == mask_liquid) != (first.pixels[i] == mask_liquid) ? 1 : 0;
        before = out.mask;
        return out;
    }

    static void measure(FrameSilhouette& out) {
        const cv::Mat mask = pixels_of(out.mask), liquid = mask == mask_liquid;
        const auto moments = cv::moments(liquid, true);
        out.area = std::size_t(std::llround(moments.m00));
        if (out.area > 0) {
            out.centre_x = moments.m10 / moments.m00;
            out.centre_y = moments.m01 / moments.m00;
        }
        const auto box = cv::boundingRect(liquid);
        out.left = box.x;
        out.top = box.y;
        out.right = box.x + box.width - 1;
        out.bottom = box.y + box.height - 1;
        out.excluded = std::size_t(cv::countNonZero(mask == mask_excluded));
        out.perimeter = perimeter_of(out.mask);
    }

    void prepare(const std::function<void(std::int64_t, std::int64_t)>& progress) {
        if (!photographs()) return;
        TimedFrame frame;
        source.read(frame);
        if (settings.registration) {
            registration = Registration(frame.image, {});
            if (!registration.possible())
                notes.push_back("the background has too little texture: frames are not registered, and a camera that "
                                "moves would not be noticed");
        }
        if (compares()) {
            auto empty = learn_empty_scene(source, settings, registration, progress);
            notes.push_back(empty.note);
            rough.set_background(std::move(empty.model));
        }
        look_through(progress);
        source.rewind();
        shift = {};
        before = {};
    }

    // Some frames over the clip determine the grey level and the mixing.
    void look_through(const std::function<void(std::int64_t, std::int64_t)>& progress) {
        const bool level = settings.method == SilhouetteMethod::threshold && settings.level <= 0;
        const bool space = settings.sub_pixel && mixing == MixingSpace::automatic;
        if (!level && !space) return;
        std::vector<TimedFrame> seen;
        TimedFrame frame;
        source.rewind();
        while (source.read(frame)) {
            const auto every = std::max<std::int64_t>(1, count / looks);
            if (frame.index % every == every - 1) seen.push_back(frame);
            progress(frame.index + 1, count);
        }
        if (level) find_level(seen);
        if (space) find_mixing(seen);
    }

    void find_level(const std::vector<TimedFrame>& seen) {
        std::vector<double> histogram(256, 0);
        for (const auto& frame : seen) {
            cv::Mat grey;
            cv::cvtColor(pixels_of(frame.image), grey, cv::COLOR_RGB2GRAY);
            for (int y = 0; y < grey.rows; ++y)
                for (int x = 0; x < grey.cols; ++x) ++histogram[grey.at<std::uint8_t>(y, x)];
        }
        rough.set_level(histogram);
        notes.push_back(
            "grey level " + tenths(rough.level()) + " of 255 parts liquid and background, by Otsu's method");
    }

    void find_mixing(const std::vector<TimedFrame>& seen) {
        Unevenness sum;
        shift = {};
        for (auto frame : seen) {
            align(frame);
            const auto found = make_rough(frame);
            before = found.mask;
            if (found.mask.area() < enough_liquid) continue;
            const auto uneven = measure_unevenness(frame.image, rough.background(), found.mask);
            sum.light += uneven.light / looks;
            sum.code += uneven.code / looks;
        }
        // Uneven light on the liquid makes its contours uneven in both: only an even profile is a criterion.
        const bool code = sum.code < 0.5 * sum.light && sum.code < 0.004;
        mixing = code ? MixingSpace::code : MixingSpace::light;
        if (code) notes.push_back("blurred contours are even in the file's numbers, not in light: mixing: code");
    }
};

SilhouetteMaker::SilhouetteMaker(FrameSource& source, const SilhouetteSettings& settings,
    const std::function<void(std::int64_t, std::int64_t)>& progress)
    : state_(std::make_unique<State>(source, settings)) {
    cv::setNumThreads(1);
    state_->prepare(progress);
    source.rewind();
}
SilhouetteMaker::~SilhouetteMaker() = default;

std::optional<FrameSilhouette> SilhouetteMaker::next(TimedFrame& frame) {
    if (!state_->source.read(frame)) return std::nullopt;
    state_->align(frame);
    return state_->make(frame);
}

const std::vector<std::string>& SilhouetteMaker::notes() const { return state_->notes; }

std::optional<MotionStart> find_motion_start(const std::vector<FrameSilhouette>& silhouettes) {
    if (silhouettes.size() < 2) return std::nullopt;
    // A contour at rest flickers by a few hundredths of a pixel; a speck is no motion.
    const double moving = std::max(40.0, 0.2 * double(silhouettes.front().perimeter)), still = moving / 4;
    for (std::size_t k = 1; k < silhouettes.size(); ++k) {
        if (double(silhouettes[k].moved) <= moving) continue;
        if (k + 1 < silhouettes.size() && double(silhouettes[k + 1].moved) <= moving) continue; // a flash
        std::size_t last = k - 1;
        while (last > 0 && double(silhouettes[last].moved) > still) --last;
        MotionStart start;
        start.frame = silhouettes[k].index;
        start.time = 0.5 * (silhouettes[last].time + silhouettes[k].time);
        start.uncertainty = 0.5 * (silhouettes[k].time - silhouettes[last].time);
        return start;
    }
    return std::nullopt;
}

} // namespace treacle::video
