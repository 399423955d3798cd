#pragma once
#include "video/clip/frame_source.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace treacle::video {

// Severity of a finding.
enum class FindingKind {
    problem, // the clip cannot be used as it is
    warning, // silhouettes will be worse than they could be
    note,
};

// One property of a clip that the user should read.
struct Finding {
    FindingKind kind;       // a problem makes the clip unusable
    std::string text, cure; // clauses for the report; the cure may be empty
};

// Properties and faults of a clip, before anything is run.
struct ClipCheck {
    std::vector<std::int64_t> doubled;              // frames that repeat the one before while the liquid moves
    std::int64_t dropped = 0;                       // frames that are missing by the gaps of the stamps
    double brightness_low = 1, brightness_high = 1; // against the first frame
    double flicker = 0;                       // standard deviation of the change of brightness from frame to frame
    bool registered = false;                  // whether the background has texture to follow the camera by
    double largest_shift = 0;                 // of the camera [px]
    double largest_changed = 0;               // share of the background's points that changed
    std::int64_t shifted = 0, changed = 0;    // frames of the two
    double noise = 0;                         // standard deviation between the first two frames [grey levels of 255]
    std::optional<std::int64_t> first_change; // frame
    double moving_area = 0;                   // largest changed area, a share of the picture
    double contrast = 0;                      // at the contour of what has changed most [of 255]; 0: not measured
    double edge_width = 0;                    // blur there, a standard deviation [px]; 0: not measured
    double clipped = 0;                       // share of the first frame's pixels that are white without detail
    std::vector<Finding> findings;            // problems first
    bool usable() const;
};

// Reads every frame. `info` of the source, with its damage, is checked too.
ClipCheck check_clip(FrameSource& source, const std::function<void(std::int64_t, std::int64_t)>& progress);

} // namespace treacle::video
