#pragma once
#include "base/text/vec3.hpp"

#include <limits>

namespace treacle::scene {

// An axis-aligned box [m]; the default contains all of space.
struct Bounds {
    static constexpr double infinite = std::numeric_limits<double>::infinity(); // [m]
    Vec3 min{-infinite, -infinite, -infinite};                                  // [m]
    Vec3 max{infinite, infinite, infinite};                                     // [m]

    // Contains no point, and grows from there.
    static constexpr Bounds nothing() { return {{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}}; }
};

// Knowledge of a signed distance before it is found.
struct DistanceBound {
    double at_most = Bounds::infinite; // [m] no smaller than its magnitude
    int sign = 0;                      // 1 or -1; 0: unknown
};

} // namespace treacle::scene
