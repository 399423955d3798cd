#pragma once
#include "base/text/vec3.hpp"

#include <array>
#include <cmath>

// Vectors, matrices and rotations of rigid bodies, on the host.
namespace treacle::rigid {

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3 operator-(const Vec3& a) { return {-a[0], -a[1], -a[2]}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a[0], s * a[1], s * a[2]}; }
// Products and Euclidean length.
inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
// Unit vector at right angles to the unit vector n.
Vec3 any_perpendicular(const Vec3& n);

using Matrix3 = std::array<Vec3, 3>; // rows
inline constexpr Matrix3 zero_matrix{};

inline Vec3 operator*(const Matrix3& m, const Vec3& v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }
// Transpose, and the product a b.
Matrix3 transposed(const Matrix3& m);
Matrix3 product(const Matrix3& a, const Matrix3& b);
// The inverse on the axes that are free, zero elsewhere: the response to a load of a body that cannot turn about
// the other axes. A part without inertia responds with zero.
Matrix3 inverse_on(const Matrix3& symmetric, const std::array<bool, 3>& free);

// A rotation as a unit quaternion.
struct Quaternion {
    double w = 1;    // cos(angle / 2)
    Vec3 v{0, 0, 0}; // sin(angle / 2) times the unit axis

    bool operator==(const Quaternion&) const = default;
};
Quaternion product(const Quaternion& a, const Quaternion& b); // b first
Quaternion conjugate(const Quaternion& q);                    // inverse rotation of a unit quaternion
Quaternion normalised(const Quaternion& q);                   // q is not 0
// The rotation by |v| radians about v.
Quaternion rotation_by(const Vec3& v);
// The vector whose rotation_by() is q, of at most pi radians.
Vec3 rotation_vector(const Quaternion& q);
Matrix3 to_matrix(const Quaternion& q);

} // namespace treacle::rigid
