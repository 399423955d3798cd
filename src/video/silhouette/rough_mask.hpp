#pragma once
#include "video/clip/frame_source.hpp"
#include "video/mask/mask.hpp"
#include "video/silhouette/background_model.hpp"
#include "video/silhouette/brightness.hpp"
#include "video/silhouette/silhouette_settings.hpp"

#include <optional>

namespace treacle::video {

// A frame's liquid by one of the methods, before its contour is refined.
struct RoughMask {
    Mask mask;
    double gain = 1;        // brightness of the frame over that of the empty scene; threshold: of the first frame
    std::size_t shadow = 0; // [px]
};

// Masks of one clip by the method of the settings, frame after frame.
class RoughMasks {
public:
    // Before the first `make`: set_background for gmm and difference, set_level for threshold without a level.
    explicit RoughMasks(const SilhouetteSettings& settings);

    // gmm, difference: the frozen empty scene.
    void set_background(BackgroundModel&& model) { background_.emplace(std::move(model)); }
    // threshold: the grey level, from the histogram [256] of frames of the clip, by Otsu (IEEE SMC 9, 1979).
    void set_level(const std::vector<double>& histogram);
    double level() const { return level_; }

    // `before`: the silhouette of the frame before, for the brightness; empty for none.
    // `name` of the frame, for messages. InputError for masks of no two levels.
    RoughMask make(const Image& frame, const Mask& before, const std::string& name);
    // Mean of the empty scene, or empty.
    const std::vector<float>& background() const;

private:
    RoughMask by_level(const Image& frame);
    RoughMask by_colour(const Image& frame) const;
    RoughMask ready(const Image& frame, const std::string& name);

    SilhouetteSettings settings_;
    std::optional<BackgroundModel> background_;
    double level_ = 0;
    std::optional<bool> liquid_is_dark_;
    double lit_ = 0; // level of the background in the first frame
};

} // namespace treacle::video
