#pragma once
// Private to src/scene: arithmetic of Vec3 for code inside namespace treacle::scene.
#include "base/text/vec3.hpp"

#include <cmath>

namespace treacle::scene {

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3 operator-(const Vec3& a) { return {-a[0], -a[1], -a[2]}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline Vec3& operator+=(Vec3& a, const Vec3& b) { return a = a + b; }

// Products and Euclidean length; finite: no component is NaN or infinite.
inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline bool is_finite(const Vec3& a) { return std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]); }

// The unit vector along a, or `otherwise` where a is zero.
inline Vec3 unit(const Vec3& a, const Vec3& otherwise = {0, 0, 0}) {
    const double l = length(a);
    return l > 0 ? (1 / l) * a : otherwise;
}

// A unit vector at right angles to the unit vector a; on the plane z = 0 when a is.
inline Vec3 perpendicular(const Vec3& a) {
    return unit(std::abs(a[2]) < 0.9 ? Vec3{-a[1], a[0], 0} : Vec3{a[2], 0, -a[0]});
}

// v turned by `angle` [rad] about the unit vector `axis` (Rodrigues).
inline Vec3 rotated(const Vec3& v, const Vec3& axis, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return c * v + s * cross(axis, v) + ((1 - c) * dot(axis, v)) * axis;
}

} // namespace treacle::scene
