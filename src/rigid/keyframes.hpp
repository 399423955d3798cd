#pragma once
#include "rigid/algebra.hpp"
#include "scene/scene.hpp"

#include <vector>

namespace treacle::rigid {

// Pose of a body: a point X of it at the start is at centre + turn (X - centre at the start).
struct Pose {
    Vec3 centre{0, 0, 0}; // [m]
    Quaternion turn;

    bool operator==(const Pose&) const = default;
};

// Shift and rotation at a time [s], from none at time 0, at rest after the last keyframe. Between two keyframes the
// shift changes at a constant rate and the body turns about a fixed axis at a constant rate: by the difference of
// their angles when both have the same axis, otherwise by the shorter way from the one orientation to the other.
Pose interpolate(const std::vector<scene::Keyframe>& frames, double time);

} // namespace treacle::rigid
