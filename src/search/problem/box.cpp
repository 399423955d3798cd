#include "search/problem/box.hpp"

#include <algorithm>
#include <cmath>

namespace treacle::search {

namespace {
double margin(const Axis& axis) { return 0.5 * std::min(axis.step, axis.upper - axis.lower); }

// Distance from the bound of a point whose preimage is t beyond the mirror.
double bent(double t, double a) { return t < 2 * a ? t * t / (4 * a) : t - a; }
double straightened(double distance, double a) { return distance < a ? 2 * std::sqrt(a * distance) : distance + a; }

double inside_of(const Axis& axis, double y) {
    const double a = margin(axis);
    const bool below = std::isfinite(axis.lower), above = std::isfinite(axis.upper);
    if (!below && !above) return y;
    if (!above) return axis.lower + bent(std::abs(y - (axis.lower - a)), a);
    if (!below) return axis.upper - bent(std::abs(axis.upper + a - y), a);
    const double half = axis.upper - axis.lower + 2 * a; // the period of the mirrored images is twice this
    double t = std::fmod(std::abs(y - (axis.lower - a)), 2 * half);
    if (t > half) t = 2 * half - t;
    const double x = t < 0.5 * half ? axis.lower + bent(t, a) : axis.upper - bent(half - t, a);
    return std::clamp(x, axis.lower, axis.upper); // round-off
}

double preimage_of(const Axis& axis, double x) {
    const double a = margin(axis);
    if (std::isfinite(axis.lower) && x - axis.lower < a) return axis.lower - a + straightened(x - axis.lower, a);
    if (std::isfinite(axis.upper) && axis.upper - x < a) return axis.upper + a - straightened(axis.upper - x, a);
    return x;
}
} // namespace

Point Box::inside(const Point& y) const {
    Point x(y.size());
    for (std::size_t i = 0; i < y.size(); ++i) x[i] = inside_of(axes_[i], y[i]);
    return x;
}

Point Box::preimage(const Point& x) const {
    Point y(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) y[i] = preimage_of(axes_[i], x[i]);
    return y;
}

} // namespace treacle::search
