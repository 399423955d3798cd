#include "rigid/keyframes.hpp"

#include <algorithm>

namespace treacle::rigid {

namespace {
Vec3 axis_of(const scene::Keyframe& frame) { return (1 / length(frame.rotation_axis)) * frame.rotation_axis; }

Quaternion turn_of(const scene::Keyframe& frame) { return rotation_by(frame.rotation_angle * axis_of(frame)); }

Quaternion turn_between(const scene::Keyframe& from, const scene::Keyframe& to, double fraction) {
    const Vec3 axis = from.rotation_angle == 0 ? axis_of(to) : axis_of(from);
    if (to.rotation_angle == 0 || length(axis - axis_of(to)) < 1e-12) {
        return rotation_by(((1 - fraction) * from.rotation_angle + fraction * to.rotation_angle) * axis);
    }
    const auto way = product(turn_of(to), conjugate(turn_of(from)));
    return product(rotation_by(fraction * rotation_vector(way)), turn_of(from));
}
} // namespace

Pose interpolate(const std::vector<scene::Keyframe>& frames, double time) {
    if (frames.empty()) return {};
    if (time >= frames.back().time) return {frames.back().translation, turn_of(frames.back())};
    const auto next = std::upper_bound(
        frames.begin(), frames.end(), time, [](double t, const scene::Keyframe& frame) { return t < frame.time; });
    scene::Keyframe start;
    start.rotation_axis = next->rotation_axis;
    const auto& from = next == frames.begin() ? start : *(next - 1);
    const double fraction = (time - from.time) / (next->time - from.time);
    return {(1 - fraction) * from.translation + fraction * next->translation, turn_between(from, *next, fraction)};
}

} // namespace treacle::rigid
