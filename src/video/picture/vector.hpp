#pragma once
#include "base/text/vec3.hpp"

#include <cmath>

namespace treacle::video {

// Components of any floating type: pictures need single precision only.
template <class T>
using Triple = std::array<T, 3>;
using Vec3f = Triple<float>;

template <class T>
Triple<T> operator+(const Triple<T>& a, const Triple<T>& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class T>
Triple<T> operator-(const Triple<T>& a, const Triple<T>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
Triple<T> operator*(T s, const Triple<T>& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
// Products, Euclidean length and unit vector of triples; not a number for the unit vector of length 0.
template <class T>
T dot(const Triple<T>& a, const Triple<T>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
Triple<T> cross(const Triple<T>& a, const Triple<T>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
T length(const Triple<T>& a) {
    return std::sqrt(dot(a, a));
}
template <class T>
Triple<T> normalised(const Triple<T>& a) {
    return (T(1) / length(a)) * a;
}
// The type is named because std::array literals deduce nothing.
inline Vec3 normalised(const Vec3& a) { return (1 / length(a)) * a; }
template <class T>
Triple<T> mix(const Triple<T>& a, const Triple<T>& b, T t) {
    return (T(1) - t) * a + t * b;
}

inline Vec3f single(const Vec3& a) { return {float(a[0]), float(a[1]), float(a[2])}; } // in single precision

} // namespace treacle::video
