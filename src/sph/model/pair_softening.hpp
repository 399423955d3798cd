#pragma once

namespace treacle::sph {

// Keeps the direction of a pair's line finite: 0.01 of the square of the smoothing length h/2, as in Monaghan 1992. 0.01 of
// h^2 would take 4 % off the viscosity.
constexpr double pair_softening(double support) { return 0.0025 * support * support; }

} // namespace treacle::sph
