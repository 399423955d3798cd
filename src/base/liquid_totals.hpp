#pragma once
#include <array>
#include <cstdint>

namespace treacle {

// Sums over the liquid's particles, which the measurements and the step control need.
struct LiquidTotals {
    std::int64_t particles = 0;
    double mass = 0;                          // [kg], [kg/m] in 2D
    std::array<double, 3> momentum{};         // [kg m/s]
    std::array<double, 3> angular_momentum{}; // about the origin [kg m2/s]
    double kinetic_energy = 0;                // [J]
    double potential_energy = 0;              // [J], zero at the origin
    double max_speed = 0;                     // [m/s]
};

} // namespace treacle
