#include "rigid/algebra.hpp"

namespace treacle::rigid {

Vec3 any_perpendicular(const Vec3& n) {
    const Vec3 t = std::abs(n[2]) < 0.9 ? Vec3{-n[1], n[0], 0} : Vec3{n[2], 0, -n[0]};
    return (1 / length(t)) * t;
}

Matrix3 transposed(const Matrix3& m) {
    Matrix3 out;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) out[i][j] = m[j][i];
    }
    return out;
}

Matrix3 product(const Matrix3& a, const Matrix3& b) {
    const auto columns = transposed(b);
    Matrix3 out;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) out[i][j] = dot(a[i], columns[j]);
    }
    return out;
}

namespace {
Matrix3 inverse(const Matrix3& m) {
    const Vec3 a = cross(m[1], m[2]), b = cross(m[2], m[0]), c = cross(m[0], m[1]);
    const double determinant = dot(m[0], a);
    if (!(determinant > 0)) return zero_matrix;
    return transposed({(1 / determinant) * a, (1 / determinant) * b, (1 / determinant) * c});
}
} // namespace

Matrix3 inverse_on(const Matrix3& symmetric, const std::array<bool, 3>& free) {
    // A locked axis gets a unit row and column, which decouples it, and no response.
    Matrix3 reduced = symmetric;
    double scale = 0;
    for (std::size_t k = 0; k < 3; ++k) scale = std::max(scale, symmetric[k][k]);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            if (!free[i] || !free[j]) reduced[i][j] = i == j ? scale : 0;
        }
    }
    auto out = inverse(reduced);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            if (!free[i] || !free[j]) out[i][j] = 0;
        }
    }
    return out;
}

Quaternion product(const Quaternion& a, const Quaternion& b) {
    return {a.w * b.w - dot(a.v, b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};
}

Quaternion conjugate(const Quaternion& q) { return {q.w, -q.v}; }

Quaternion normalised(const Quaternion& q) {
    const double scale = 1 / std::sqrt(q.w * q.w + dot(q.v, q.v));
    return {scale * q.w, scale * q.v};
}

Quaternion rotation_by(const Vec3& v) {
    const double angle = length(v);
    // sin(a / 2) / a, by its series where the quotient loses digits.
    const double factor = angle < 1e-4 ? 0.5 - angle * angle / 48 : std::sin(angle / 2) / angle;
    return normalised({std::cos(angle / 2), factor * v});
}

Vec3 rotation_vector(const Quaternion& q) {
    const double sign = q.w < 0 ? -1 : 1, sine = length(q.v);
    if (sine == 0) return {0, 0, 0};
    return (sign * 2 * std::atan2(sine, sign * q.w) / sine) * q.v;
}

Matrix3 to_matrix(const Quaternion& q) {
    const auto& [x, y, z] = q.v;
    const double w = q.w;
    return {Vec3{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
        Vec3{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
        Vec3{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

} // namespace treacle::rigid
