#pragma once
#include <array>
#include <cstddef>

namespace treacle {

// Momentum [kg m/s] and angular momentum about the origin [kg m2/s] of liquid and bodies together, at the end of a method's step.
template <class Step>
std::array<double, 6> total_momentum(const Step& step) {
    const auto liquid = step.totals();
    auto sum = step.bodies().momentum();
    for (std::size_t k = 0; k < 3; ++k) {
        sum[k] += liquid.momentum[k];
        sum[3 + k] += liquid.angular_momentum[k];
    }
    return sum;
}

} // namespace treacle
