#pragma once
#include "video/clip/frame_source.hpp"
#include "video/mask/mask.hpp"
#include "video/silhouette/mask_cleaning.hpp"
#include "video/silhouette/registration.hpp"
#include "video/silhouette/silhouette_settings.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace treacle::video {

// One frame's silhouette and how it came about.
struct FrameSilhouette {
    std::int64_t index = 0;
    double stamp = 0, time = 0;                   // [s]
    Mask mask;                                    // in the pixels of the first frame
    std::size_t area = 0;                         // [px]
    int left = 0, top = 0, right = 0, bottom = 0; // box, both ends included; 0 -1 without liquid [px]
    double centre_x = 0, centre_y = 0;            // centroid of pixel centres [px]
    CleaningReport cleaning;
    std::size_t shadow = 0, excluded = 0; // [px]
    std::size_t moved = 0;                // pixels that differ from the first frame's silhouette [px]
    std::size_t perimeter = 0;            // pixel edges along the contour
    double faint = 0;                     // see RefinedContour [px]
    double edge_width = 0;                // blur across the contour, a standard deviation [px]
    double contrast = 0;                  // of liquid and background, of 1
    double gain = 1;                      // brightness over that of the empty scene
    FrameShift shift;
};

// The first frame that differs from those before it.
struct MotionStart {
    std::int64_t frame = 0; // index of the first moving frame
    double time = 0;        // half way between the last still and the first moving frame [s]
    double uncertainty =
        0; // half of the time from the last frame that surely is still to the first that surely moves [s]
};

// Turns a clip's frames into silhouettes, one after the other.
// Errors (InputError, with file and frame): an empty scene that is not there or has another size, a camera that moves.
class SilhouetteMaker {
public:
    // Makes the model of the empty scene; rewinds `source`. `progress(done, of)` of the frames read.
    SilhouetteMaker(FrameSource& source, const SilhouetteSettings& settings,
        const std::function<void(std::int64_t, std::int64_t)>& progress);
    ~SilhouetteMaker();

    // The next frame's; nothing after the last. `frame` receives the picture, registered onto the first.
    std::optional<FrameSilhouette> next(TimedFrame& frame);

    // Notes for a user, so far: where the empty scene was taken from, which mixing was found, drift.
    const std::vector<std::string>& notes() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

// From all silhouettes of a clip; nothing where none moves.
std::optional<MotionStart> find_motion_start(const std::vector<FrameSilhouette>& silhouettes);

} // namespace treacle::video
