#pragma once
#include "video/clip/frame_source.hpp"
#include "video/silhouette/background_model.hpp"
#include "video/silhouette/registration.hpp"
#include "video/silhouette/silhouette_settings.hpp"

#include <functional>

namespace treacle::video {

// Frozen model of the scene without liquid.
struct EmptyScene {
    BackgroundModel model; // at the brightness of the first frame of the model
    std::string note;      // where it was taken from
};

// Model of the scene without liquid from what `settings.empty` names, else from the frames before the first that
// changes. Each picture is registered onto the clip's first frame and set to the brightness of the first of the model.
// InputError: no such frames, another size, liquid from the first frame on, nothing that changes.
EmptyScene learn_empty_scene(FrameSource& source, const SilhouetteSettings& settings, const Registration& registration,
    const std::function<void(std::int64_t, std::int64_t)>& progress);

// A frame's shift, begun from that of the frame before, or from the peak of the phase correlation where that fails.
FrameShift follow_shift(const Registration& registration, const Image& frame, const FrameShift& before);

// Index of the first frame that differs from the first one in more than noise, exposure and small shifts; -1 for none.
std::int64_t find_first_change(FrameSource& source, const Registration& registration,
    const std::function<void(std::int64_t, std::int64_t)>& progress);

} // namespace treacle::video
