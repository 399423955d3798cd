#include "video/silhouette/empty_scene.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"
#include "video/clip/picture_sequence.hpp"
#include "video/mask/pixels.hpp"
#include "video/picture/codecs.hpp"
#include "video/silhouette/brightness.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace treacle::video {

namespace {
constexpr std::int64_t few = 5;       // frames for a rough estimate of the noise
constexpr std::int64_t many = 100;    // more than these add nothing
constexpr double least_changed = 4;   // blocks of 4 x 4 pixels
constexpr float block_difference = 7; // [grey levels]

Image load_picture(const std::filesystem::path& path) {
    if (is_heif(path)) throw heif_refused(path);
    const cv::Mat read = codecs().read(path.string(), cv::IMREAD_COLOR);
    if (read.empty())
        throw InputError(
            {path.string(), "is no picture that can be read", "empty.picture names it", "PNG and JPEG are usual"});
    cv::Mat rgb;
    cv::cvtColor(read, rgb, cv::COLOR_BGR2RGB);
    return rgb_image_of(rgb);
}

std::vector<float> floats(const Image& image) { return {image.pixels.begin(), image.pixels.end()}; }

// Adds frames to the model, each registered and at the brightness of the first.
class Learner {
public:
    Learner(const SilhouetteSettings& settings, const Registration& registration, const ClipInfo& clip, int of)
        : settings_(settings), registration_(registration), clip_(clip), of_(of), model_(settings) {}

    void add(const Image& frame, const std::string& name) {
        if (frame.width != clip_.width || frame.height != clip_.height)
            throw InputError(
                {name, "is " + std::to_string(frame.width) + " x " + std::to_string(frame.height) + " pixels",
                    clip_.file + " is " + std::to_string(clip_.width) + " x " + std::to_string(clip_.height),
                    "film the empty scene with the same camera and orientation"});
        Image moved = frame;
        if (registration_.possible()) {
            shift_ = follow_shift(registration_, frame, shift_);
            if (shift_.changed > 0.7)
                throw InputError({name, "is another scene than " + clip_.file, "most of the background differs",
                    "film the empty scene from the same place"});
            moved = undo_shift(frame, shift_);
        }
        if (first_.empty())
            first_ = floats(moved);
        else if (settings_.brightness)
            moved = match_brightness(moved, first_, {}).image;
        model_.learn(moved, of_);
    }

    BackgroundModel finish() {
        model_.freeze();
        return std::move(model_);
    }

private:
    const SilhouetteSettings& settings_;
    const Registration& registration_;
    const ClipInfo& clip_;
    int of_;
    BackgroundModel model_;
    FrameShift shift_;
    std::vector<float> first_;
};

EmptyScene from_frames(FrameSource& source, const SilhouetteSettings& settings, const Registration& registration,
    FrameSpan span, const std::string& note) {
    const auto count = std::ssize(source.info().stamps);
    std::vector<std::int64_t> wanted;
    for (std::int64_t k = 0; k < count; ++k)
        if (span.contains(k, count)) wanted.push_back(k);
    if (wanted.empty())
        throw InputError(
            {source.info().file, "has no frames " + std::to_string(span.first) + " to " + std::to_string(span.last),
                "it has " + std::to_string(count) + " frames", "give frames of the clip for empty.frames"});
    const auto stride = std::max<std::int64_t>(1, std::ssize(wanted) / many);
    Learner learner(settings, registration, source.info(), int((std::ssize(wanted) + stride - 1) / stride));
    source.rewind();
    for (TimedFrame frame; frame.index < wanted.back() && source.read(frame);) {
        if (!span.contains(frame.index, count) || (frame.index - wanted.front()) % stride != 0) continue;
        learner.add(frame.image, source.info().file + ", frame " + std::to_string(frame.index));
    }
    return {learner.finish(), note};
}
} // namespace

FrameShift follow_shift(const Registration& registration, const Image& frame, const FrameShift& before) {
    auto found = registration.find(frame, before);
    if (!found.known || found.changed < 0.3) return found;
    // Far off: repeated on a lattice of starts around the frame before.
    for (const double step : {4.0, 9.0, 16.0})
        for (int direction = 0; direction < 8; ++direction) {
            auto start = before;
            start.x += step * std::cos(direction * 0.785398);
            start.y += step * std::sin(direction * 0.785398);
            const auto other = registration.find(frame, start);
            if (other.known && other.changed < found.changed) found = other;
            if (found.changed < 0.3) return found;
        }
    return found;
}

std::int64_t find_first_change(FrameSource& source, const Registration& registration,
    const std::function<void(std::int64_t, std::int64_t)>& progress) {
    const auto count = std::ssize(source.info().stamps);
    std::vector<float> first;
    cv::Mat small_first;
    FrameShift shift;
    std::int64_t candidate = -1;
    const auto blocks = [](const Image& image) {
        cv::Mat grey, small;
        cv::cvtColor(pixels_of(image), grey, cv::COLOR_RGB2GRAY);
        cv::resize(grey, small, {}, 0.25, 0.25, cv::INTER_AREA);
        small.convertTo(small, CV_32F);
        return small;
    };
    source.rewind();
    for (TimedFrame frame; source.read(frame);) {
        progress(frame.index + 1, count);
        Image image = frame.image;
        if (registration.possible()) {
            shift = follow_shift(registration, image, shift);
            image = undo_shift(image, shift);
        }
        if (first.empty()) {
            first = floats(image);
            small_first = blocks(image);
            continue;
        }
        const cv::Mat difference = cv::abs(blocks(match_brightness(image, first, {}).image) - small_first);
        const bool changed = cv::countNonZero(difference > block_difference) >= least_changed;
        if (changed && candidate >= 0) return candidate; // two in a row: no flash
        candidate = changed ? frame.index : -1;
    }
    return candidate;
}

EmptyScene learn_empty_scene(FrameSource& source, const SilhouetteSettings& settings, const Registration& registration,
    const std::function<void(std::int64_t, std::int64_t)>& progress) {
    const auto& file = source.info().file;
    const auto& empty = settings.empty;
    if (!empty.frames.empty()) {
        const auto span = read_frame_span(empty.frames, "empty.frames");
        return from_frames(source, settings, registration, span, "the empty scene is frames " + empty.frames);
    }
    if (!empty.picture.empty()) {
        Learner learner(settings, registration, source.info(), 1);
        learner.add(load_picture(empty.picture), empty.picture);
        return {learner.finish(), "the empty scene is " + empty.picture + ": one picture, whose noise is not known"};
    }
    if (!empty.clip.empty()) {
        SourceRequest request;
        request.clip = empty.clip;
        request.rate = 30; // times do not count here
        const auto clip = open_frames(request);
        const auto stride = std::max<std::int64_t>(1, std::ssize(clip->info().stamps) / many);
        Learner learner(settings, registration, source.info(), int(std::ssize(clip->info().stamps) / stride));
        for (TimedFrame frame; clip->read(frame);)
            if (frame.index % stride == 0)
                learner.add(frame.image, empty.clip + ", frame " + std::to_string(frame.index));
        return {learner.finish(), "the empty scene is " + empty.clip};
    }
    const auto change = find_first_change(source, registration, progress);
    if (change < 0)
        throw InputError({file, "nothing moves in it", "no frame differs from the first one",
            "choose the clip with the experiment, or lower its noise"});
    if (change < few)
        throw InputError(
            {file, "has no empty scene: frame " + std::to_string(change) + " already differs from the first one",
                "the background is learnt from frames without liquid",
                "give empty.frames, empty.picture or empty.clip, or film 2 s of the empty scene first"});
    const auto last = change - 2; // one more for a change too faint to be detected
    return from_frames(source, settings, registration, {0, last},
        "the empty scene is frames 0:" + std::to_string(last) + ", before the first change in frame " +
            std::to_string(change));
}

} // namespace treacle::video
