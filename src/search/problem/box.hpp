#pragma once
#include "search/problem/search.hpp"

namespace treacle::search {

// A smooth map of the whole space onto the points within the bounds (Hansen's BoxConstraintsLinQuadTransformation in
// pycma): (B1) the identity farther than a from a bound, (B2) the parabola lower + t^2 / (4 a) with
// t = y - (lower - a) < 2 a nearer to it, mirrored beyond; a is half a step, or half the width of a narrow range.
// A search in y has no bounds, so none of its statistics are cut off at one.
class Box {
public:
    explicit Box(std::vector<Axis> axes) : axes_(std::move(axes)) {}

    Point inside(const Point& y) const;   // (B1), (B2) for each axis; y: [n], any finite values
    Point preimage(const Point& x) const; // of a point within the bounds

private:
    std::vector<Axis> axes_;
};

} // namespace treacle::search
