#pragma once
#include <cmath>

namespace treacle::search {

// Loss of a residual in units of its noise, linear beyond `bend` (Huber 1964).
inline double huber_loss(double residual, double bend) {
    const double u = std::abs(residual);
    return u <= bend ? 0.5 * u * u : bend * u - 0.5 * bend * bend;
}

} // namespace treacle::search
