#pragma once
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace treacle {
class Declaration;
}

namespace treacle::identify {

// Normal of a mirror plane, an axis of the scene.
enum class MirrorAxis { none, x, y, z };

// Frequency with which pixels are liquid, over windows of time. For liquid that coils or folds it depends on the
// viscosity, and not on the phase or the sense of turning.
struct Occupancy {
    int windows = 5;
    std::vector<double> levels{0.1, 0.3, 0.5, 0.7, 0.9}; // shares of the frames whose contours are compared
    MirrorAxis mirror = MirrorAxis::none;                // normal of a plane in which the run is mirrored
    double mirror_at = 0;                                // [m] where that plane lies

    // Keys of the block `occupancy` of an experiment.
    void declare(Declaration& d);
};

// Frames of each window [begin, end): as many in each, but for one.
std::vector<std::pair<std::size_t, std::size_t>> windows_of(std::size_t frames, int windows);

} // namespace treacle::identify
