#pragma once
#include "scene/sampling/signed_distance.hpp"

#include <array>
#include <cstddef>

namespace treacle::scene {

// Signed distances of a region at positions that follow each other closely, the same bit for bit as
// SolidRegion::distance(). A distance changes by no more than the way between two positions, so that those found last bound
// the next one, and tell its sign where no surface can be between: of meshes the sign is most of the cost.
class NearbyDistance {
public:
    explicit NearbyDistance(const SolidRegion& region) : region_(&region) {}

    double operator()(const Vec3& x); // [m] negative inside, x [m]

private:
    DistanceBound bound_at(const Vec3& x) const;

    struct Known {
        Vec3 position{0, 0, 0}; // [m]
        double distance = 0;    // [m]
    };
    const SolidRegion* region_;
    std::array<Known, 128> known_{}; // the last ones, in a ring
    std::size_t count_ = 0;          // found so far
};

} // namespace treacle::scene
