#pragma once
#include "kokkos/types.hpp"

namespace treacle::sph {

// A symmetric 3 x 3 matrix: xx, yy, zz, xy, xz, yz.
struct Symmetric {
    double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0; // in the unit of the quantity

    // Adds weight v v^T of v = (x, y, z).
    KOKKOS_INLINE_FUNCTION void add_square(double weight, double x, double y, double z) {
        xx += weight * x * x;
        yy += weight * y * y;
        zz += weight * z * z;
        xy += weight * x * y;
        xz += weight * x * z;
        yz += weight * y * z;
    }
    // Product with a vector.
    KOKKOS_INLINE_FUNCTION void times(const double v[3], double out[3]) const {
        out[0] = xx * v[0] + xy * v[1] + xz * v[2];
        out[1] = xy * v[0] + yy * v[1] + yz * v[2];
        out[2] = xz * v[0] + yz * v[1] + zz * v[2];
    }
};

// a b a
KOKKOS_INLINE_FUNCTION Symmetric enclosed(const Symmetric& a, const Symmetric& b) {
    const double columns[3][3] = {{a.xx, a.xy, a.xz}, {a.xy, a.yy, a.yz}, {a.xz, a.yz, a.zz}};
    double out[3][3];
    for (int l = 0; l < 3; ++l) {
        double middle[3];
        b.times(columns[l], middle);
        a.times(middle, out[l]);
    }
    return {out[0][0], out[1][1], out[2][2], out[0][1], out[0][2], out[1][2]};
}

using Array6 = Kokkos::View<double* [6], Kokkos::LayoutRight, Memory>; // [n][6] elements in the order of Symmetric

// Rows of a View of six numbers.
template <class View>
KOKKOS_INLINE_FUNCTION Symmetric read_symmetric(const View& from, int i) {
    return {from(i, 0), from(i, 1), from(i, 2), from(i, 3), from(i, 4), from(i, 5)};
}
template <class View>
KOKKOS_INLINE_FUNCTION void write_symmetric(const Symmetric& a, const View& to, int i) {
    using Value = typename View::non_const_value_type; // float or double
    to(i, 0) = static_cast<Value>(a.xx);
    to(i, 1) = static_cast<Value>(a.yy);
    to(i, 2) = static_cast<Value>(a.zz);
    to(i, 3) = static_cast<Value>(a.xy);
    to(i, 4) = static_cast<Value>(a.xz);
    to(i, 5) = static_cast<Value>(a.yz);
}

// Tangent of the rotation that makes the element zero, by the difference of the diagonal's and twice the element.
KOKKOS_INLINE_FUNCTION double rotation_tangent(double difference, double twice) {
    constexpr double far = 1e100; // beyond it the square below might overflow
    if (math::fabs(difference) > far * math::fabs(twice)) return 0.5 * twice / difference;
    const double theta = difference / twice;
    return (theta < 0 ? -1 : 1) / (math::fabs(theta) + math::sqrt(theta * theta + 1));
}

// Eigenvalues and eigenvectors (columns) of a symmetric matrix by cyclic Jacobi rotations (Golub & Van Loan, 8.5).
struct Eigen3 {
    double value[3];     // in no order
    double vector[3][3]; // unit eigenvectors, by columns
};
KOKKOS_INLINE_FUNCTION Eigen3 eigen(const Symmetric& s) {
    double a[3][3] = {{s.xx, s.xy, s.xz}, {s.xy, s.yy, s.yz}, {s.xz, s.yz, s.zz}};
    Eigen3 out{{0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    constexpr int sweeps = 8; // converges quadratically: five reach round-off
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (int p = 0; p < 2; ++p) {
            for (int q = p + 1; q < 3; ++q) {
                if (a[p][q] == 0) continue;
                const double t = rotation_tangent(a[q][q] - a[p][p], 2 * a[p][q]);
                const double c = 1 / math::sqrt(t * t + 1), sine = t * c;
                for (int k = 0; k < 3; ++k) {
                    const double kp = a[k][p], kq = a[k][q];
                    a[k][p] = c * kp - sine * kq;
                    a[k][q] = sine * kp + c * kq;
                }
                for (int k = 0; k < 3; ++k) {
                    const double pk = a[p][k], qk = a[q][k];
                    a[p][k] = c * pk - sine * qk;
                    a[q][k] = sine * pk + c * qk;
                    const double vp = out.vector[k][p], vq = out.vector[k][q];
                    out.vector[k][p] = c * vp - sine * vq;
                    out.vector[k][q] = sine * vp + c * vq;
                }
            }
        }
    }
    for (int k = 0; k < 3; ++k) out.value[k] = a[k][k];
    return out;
}

// The inverse of a positive definite matrix.
KOKKOS_INLINE_FUNCTION Symmetric inverse(const Symmetric& a) {
    const double cxx = a.yy * a.zz - a.yz * a.yz, cxy = a.xz * a.yz - a.xy * a.zz, cxz = a.xy * a.yz - a.xz * a.yy;
    const double scale = 1 / (a.xx * cxx + a.xy * cxy + a.xz * cxz);
    return {scale * cxx, scale * (a.xx * a.zz - a.xz * a.xz), scale * (a.xx * a.yy - a.xy * a.xy), scale * cxy,
        scale * cxz, scale * (a.xy * a.xz - a.xx * a.yz)};
}

// True when all eigenvalues exceed `least` for certain: the two larger ones have at most half of the trace each on
// average.
KOKKOS_INLINE_FUNCTION bool surely_above(const Symmetric& a, double least) {
    const double trace = a.xx + a.yy + a.zz;
    const double determinant =
        a.xx * (a.yy * a.zz - a.yz * a.yz) - a.xy * (a.xy * a.zz - a.xz * a.yz) + a.xz * (a.xy * a.yz - a.xz * a.yy);
    return determinant > least * 0.25 * trace * trace;
}

// The function of the eigenvalues that exceed `least` on the span of their eigenvectors, 0 across it.
template <class Function>
KOKKOS_INLINE_FUNCTION Symmetric apply_above(const Symmetric& a, double least, const Function& function) {
    const Eigen3 e = eigen(a);
    Symmetric out;
    for (int k = 0; k < 3; ++k) {
        if (e.value[k] > least) out.add_square(function(e.value[k]), e.vector[0][k], e.vector[1][k], e.vector[2][k]);
    }
    return out;
}

// The inverse on the span of the eigenvectors whose eigenvalues exceed `least`, 0 across it.
KOKKOS_INLINE_FUNCTION Symmetric truncated_pseudo_inverse(const Symmetric& a, double least) {
    if (surely_above(a, least)) return inverse(a); // spares the eigenvectors of nearly all
    return apply_above(a, least, [](double value) { return 1 / value; });
}

// The projector on the range of a positive semidefinite matrix whose eigenvalues are 0 or comparable.
KOKKOS_INLINE_FUNCTION Symmetric range_projector(const Symmetric& a) {
    constexpr double comparable = 1e-6;
    const double trace = a.xx + a.yy + a.zz, least = comparable * trace;
    if (surely_above(a, least)) return {1, 1, 1, 0, 0, 0};
    if (a.zz == 0 && a.xx * a.yy - a.xy * a.xy > least * trace) return {1, 1, 0, 0, 0, 0}; // of a 2D scene
    return apply_above(a, least, [](double) { return 1.0; });
}

// The symmetric part of a gradient within the span of the neighbours, in which a rotation has none.
KOKKOS_INLINE_FUNCTION void strain(const Symmetric& spanned, const double g[3][3], double s[3][3]) {
    double half[3][3]; // G is 0 across the span on the right already: only the left side is cut
    for (int l = 0; l < 3; ++l) {
        const double column[3] = {g[0][l], g[1][l], g[2][l]};
        double cut[3];
        spanned.times(column, cut);
        for (int k = 0; k < 3; ++k) half[k][l] = cut[k];
    }
    for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) s[k][l] = 0.5 * (half[k][l] + half[l][k]);
    }
}

} // namespace treacle::sph
