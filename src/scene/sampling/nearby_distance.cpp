#include "scene/sampling/nearby_distance.hpp"

#include "scene/shapes/vector_math.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::scene {

DistanceBound NearbyDistance::bound_at(const Vec3& x) const {
    constexpr double slack = 1e-9;     // relative, for round-off
    constexpr std::size_t nearest = 8; // that bound the magnitude well
    DistanceBound out;
    for (std::size_t i = 0; i < std::min(count_, known_.size()) && (i < nearest || out.sign == 0); ++i) {
        const Known& known = known_[(count_ - 1 - i) % known_.size()];
        const double way = length(x - known.position), there = std::abs(known.distance);
        out.at_most = std::min(out.at_most, (1 + slack) * (there + way));
        if ((1 + slack) * way < there) out.sign = known.distance < 0 ? -1 : 1;
    }
    return out;
}

double NearbyDistance::operator()(const Vec3& x) {
    const double distance = region_->distance(x, bound_at(x));
    known_[count_++ % known_.size()] = {x, distance};
    return distance;
}

} // namespace treacle::scene
