#include "video/silhouette/background_model.hpp"

#include "video/mask/pixels.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/background_segm.hpp>

namespace treacle::video {

namespace {
constexpr std::uint8_t mog_shadow = 127; // MOG2's label
} // namespace

struct BackgroundModel::State {
    SilhouetteSettings settings;
    cv::Ptr<cv::BackgroundSubtractorMOG2> mixture;
    int learnt = 0;
    cv::Mat sum, squares; // CV_32FC3
    std::vector<float> mean;
    cv::Mat deviation; // CV_32FC3
    std::size_t shadows = 0;

    Mask by_mixture(const Image& frame) {
        cv::Mat labels;
        mixture->apply(pixels_of(frame), labels, 0);
        shadows = std::size_t(cv::countNonZero(labels == mog_shadow));
        return mask_of(labels == 255);
    }

    // A pixel is foreground when it leaves the noise and is no darker or brighter copy of the background.
    Mask by_difference(const Image& frame) {
        Mask mask{frame.width, frame.height, std::vector<std::uint8_t>(frame.pixels.size() / 3)};
        const auto* noise = deviation.ptr<float>();
        const auto floor = float(settings.min_difference), factor = float(settings.deviations);
        shadows = 0;
        for (std::size_t i = 0; i < mask.pixels.size(); ++i) {
            float product = 0, square = 0;
            bool differs = false;
            for (std::size_t c = 0; c < 3; ++c) {
                const float value = frame.pixels[3 * i + c], b = mean[3 * i + c];
                differs = differs || std::abs(value - b) > std::max(floor, factor * noise[3 * i + c]);
                product += value * b;
                square += b * b;
            }
            if (!differs) continue;
            const float ratio = square > 0 ? product / square : 2;
            float rest = 0;
            for (std::size_t c = 0; c < 3; ++c)
                rest = std::max(rest, std::abs(float(frame.pixels[3 * i + c]) - ratio * mean[3 * i + c]));
            const bool copy =
                rest < floor && ratio >= float(settings.shadow_ratio) && ratio <= float(settings.highlight_ratio);
            if (copy && ratio < 1) ++shadows;
            mask.pixels[i] = copy ? mask_background : mask_liquid;
        }
        return mask;
    }
};

BackgroundModel::BackgroundModel(const SilhouetteSettings& settings) : state_(std::make_unique<State>()) {
    cv::setNumThreads(1);
    state_->settings = settings;
}
BackgroundModel::~BackgroundModel() = default;
BackgroundModel::BackgroundModel(BackgroundModel&&) noexcept = default;

void BackgroundModel::learn(const Image& frame, int of_frames) {
    auto& s = *state_;
    const cv::Mat rgb = pixels_of(frame);
    if (s.learnt == 0) {
        s.sum = cv::Mat::zeros(rgb.size(), CV_32FC3);
        s.squares = cv::Mat::zeros(rgb.size(), CV_32FC3);
        const bool known_shadows = s.settings.shadow_ratio < 1;
        s.mixture = cv::createBackgroundSubtractorMOG2(
            std::max(2, of_frames), s.settings.deviations * s.settings.deviations, known_shadows);
        s.mixture->setShadowThreshold(s.settings.shadow_ratio);
    }
    cv::Mat real;
    rgb.convertTo(real, CV_32FC3);
    s.sum += real;
    s.squares += real.mul(real);
    ++s.learnt;
    if (s.settings.method == SilhouetteMethod::gmm) {
        cv::Mat ignored;
        s.mixture->apply(rgb, ignored, 1.0 / s.learnt); // a running mean of all frames so far
    }
}

void BackgroundModel::freeze() {
    auto& s = *state_;
    const float n = float(std::max(1, s.learnt));
    const cv::Mat mean = s.sum / n;
    cv::Mat variance = s.squares / n - mean.mul(mean);
    variance = cv::max(variance, 1.0F); // rounding to grey levels, and a picture alone has no spread
    cv::sqrt(variance, s.deviation);
    s.mean.assign(mean.ptr<float>(), mean.ptr<float>() + 3 * mean.total());
}

Mask BackgroundModel::classify(const Image& frame) const {
    return state_->settings.method == SilhouetteMethod::gmm ? state_->by_mixture(frame) : state_->by_difference(frame);
}
std::size_t BackgroundModel::shadows() const { return state_->shadows; }
const std::vector<float>& BackgroundModel::mean() const { return state_->mean; }

} // namespace treacle::video
