#pragma once
#include "video/mask/mask.hpp"
#include "video/picture/image.hpp"
#include "video/silhouette/silhouette_settings.hpp"

#include <memory>
#include <vector>

namespace treacle::video {

// The scene without liquid: a Gaussian mixture a pixel (Zivkovic 2004, OpenCV's MOG2) or its mean and noise, computed
// from frames and then left as it is: liquid that stands still stays foreground.
class BackgroundModel {
public:
    // For the mixture and the difference.
    explicit BackgroundModel(const SilhouetteSettings& settings);
    ~BackgroundModel();
    BackgroundModel(BackgroundModel&&) noexcept;
    BackgroundModel& operator=(BackgroundModel&&) = delete;

    // One empty frame of the `of_frames` of the model; all of one size, at one brightness.
    void learn(const Image& frame, int of_frames);
    // After the last empty frame.
    void freeze();

    // Foreground as 255, the rest 0; shadows and highlights count as background. `frame` at the background's brightness.
    Mask classify(const Image& frame) const;
    // Pixels that the last call took for shadows [px].
    std::size_t shadows() const;
    // Mean of the empty frames [height][width][3], of 255.
    const std::vector<float>& mean() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace treacle::video
