#pragma once
#include "search/problem/matrix.hpp"

namespace treacle::search {

// Bounds of a move.
struct Room {
    std::vector<double> lower, upper; // [n] of its components; lower <= 0 <= upper
    double radius = 1;                // upper bound of |d|
};

// The d of least d^T a d / 2 + b^T d within the room, a [n][n] positive semidefinite: Levenberg's damping, found by bisection, keeps it within
// the radius, and components at a bound stay there as long as the slope leads out (an active set).
std::vector<double> bounded_move(const Matrix& a, std::span<const double> b, const Room& room);

} // namespace treacle::search
