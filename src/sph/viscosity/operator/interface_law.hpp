#pragma once
#include "sph/model/symmetric.hpp"

// Stress beside an interface of viscosity, at which the shear rate jumps and the traction does not (src/sph/theory.md, Interfaces).
namespace treacle::sph {

// a.b, and out = A x.
KOKKOS_INLINE_FUNCTION double inner(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
KOKKOS_INLINE_FUNCTION void times(const double a[3][3], const double x[3], double out[3]) {
    for (int k = 0; k < 3; ++k) out[k] = inner(a[k], x);
}
// v less its part along the unit vector n.
KOKKOS_INLINE_FUNCTION void cut(const double n[3], double v[3]) {
    const double along = inner(n, v);
    for (int k = 0; k < 3; ++k) v[k] -= along * n[k];
}
KOKKOS_INLINE_FUNCTION void cut_columns(const double n[3], double a[3][3]) {
    for (int l = 0; l < 3; ++l) {
        double column[3] = {a[0][l], a[1][l], a[2][l]};
        cut(n, column);
        for (int k = 0; k < 3; ++k) a[k][l] = column[k];
    }
}

// h = (mu_j - mu_i) / (mu_i + mu_j), of viscosities or viscous coefficients. A pair of two liquids counts f = 1 + h times for i, 1 - h times for j.
KOKKOS_INLINE_FUNCTION double viscous_contrast(double own, double other) {
    return own + other > 0 ? (other - own) / (own + other) : 0;
}
// Contrast h of two particles, 0 within one liquid.
struct ViscousContrast {
    bool any = false;
    Array<double> viscous_coefficient; // dt/m V mu, ghosts' as well
    Array<int> liquid;                 // [particles]

    KOKKOS_INLINE_FUNCTION double operator()(int i, int j) const {
        return any && liquid(i) != liquid(j) ? viscous_contrast(viscous_coefficient(i), viscous_coefficient(j)) : 0;
    }
};
// f^2 - 1
KOKKOS_INLINE_FUNCTION double excess_square(double h) { return h * (2 + h); }

// False for the 0 that stands for no normal.
KOKKOS_INLINE_FUNCTION bool is_normal(double x, double y, double z) { return x != 0 || y != 0 || z != 0; }

// Moments of the neighbours around a particle beside an interface, of which its stress is made.
struct InterfaceShape {
    enum { numbers = 18 };
    Symmetric spread, squares;    // B = sum w f x x^T with the solids; sum w f (f^2 - 1) x x^T
    double skew[3] = {0, 0, 0};   // b = sum w f h (n.x) x
    double normal[3] = {0, 0, 0}; // n, 0: none, and its stress is that of one liquid

    // True beside an interface.
    KOKKOS_INLINE_FUNCTION bool has_normal() const { return is_normal(normal[0], normal[1], normal[2]); }
};
using InterfaceShapes = Kokkos::View<double * [InterfaceShape::numbers], Kokkos::LayoutRight, Memory>; // [rows][18]

// Shape in row `row`: spread, squares, skew, normal, one after the other.
template <class Numbers>
KOKKOS_INLINE_FUNCTION InterfaceShape read_shape(const Numbers& from, int row) {
    const auto symmetric = [&](int at) {
        return Symmetric{from(row, at), from(row, at + 1), from(row, at + 2), from(row, at + 3), from(row, at + 4),
            from(row, at + 5)};
    };
    InterfaceShape out{symmetric(0), symmetric(6)};
    for (int k = 0; k < 3; ++k) out.skew[k] = from(row, 12 + k), out.normal[k] = from(row, 15 + k);
    return out;
}
KOKKOS_INLINE_FUNCTION void write_shape(const InterfaceShape& shape, const InterfaceShapes& to, int row) {
    const Symmetric two[2] = {shape.spread, shape.squares};
    for (int m = 0; m < 2; ++m) {
        const double numbers[6] = {two[m].xx, two[m].yy, two[m].zz, two[m].xy, two[m].xz, two[m].yz};
        for (int k = 0; k < 6; ++k) to(row, 6 * m + k) = numbers[k];
    }
    for (int k = 0; k < 3; ++k) to(row, 12 + k) = shape.skew[k], to(row, 15 + k) = shape.normal[k];
}

// Sums over its pairs: w f (u_i - u_j) x^T with the solids, w f h (n.x) (u_i - u_j), and w f (f^2 - 1) (u_i - u_j) x^T.
struct InterfaceSums {
    double n[3][3] = {}, sheared[3] = {}, squares[3][3] = {}; // [1/s]

    // A pair, x to the particle from the other one, u likewise.
    KOKKOS_INLINE_FUNCTION void add(double w, double h, const double normal[3], const double x[3], const double u[3]) {
        const double weight = w * (1 + h);
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) n[k][l] += weight * u[k] * x[l];
        }
        if (h == 0) return;
        const double square = weight * excess_square(h), shear = weight * h * inner(normal, x);
        for (int k = 0; k < 3; ++k) {
            sheared[k] += shear * u[k];
            for (int l = 0; l < 3; ++l) squares[k][l] += square * u[k] * x[l];
        }
    }
};

// Pairs of a particle are pulled by w f [(Q + (f^2 - 1) across) x + h tilted (n.x) + kappa c (1 + (f^2 - 1) P) u].
struct InterfaceStress {
    double q[3][3], tilted[3], across[3][3]; // [m2/s]
};
// Stress, normal and damping kappa c of a particle, as its pairs read them.
struct InterfacePull {
    InterfaceStress stress;
    double normal[3], damping; // [1], [m2]

    // True beside an interface.
    KOKKOS_INLINE_FUNCTION bool has_normal() const { return is_normal(normal[0], normal[1], normal[2]); }
    // Adds a pair's pull [m/s], with w [1/m2], x [m] and u [m/s] from the other one to the particle.
    KOKKOS_INLINE_FUNCTION void add(double w, double h, const double x[3], const double u[3], double to[3]) const {
        const double weight = w * (1 + h), square = excess_square(h);
        const double facing = inner(normal, x), parting = inner(normal, u);
        for (int k = 0; k < 3; ++k) {
            const double turned = inner(stress.across[k], x) + damping * (u[k] - normal[k] * parting);
            to[k] +=
                weight * (inner(stress.q[k], x) + damping * u[k] + square * turned + h * stress.tilted[k] * facing);
        }
    }
};

// The stress of a particle beside an interface: that of V mu (S:S + kappa/2 sum w f |r|^2), c = dt/m V mu (src/sph/theory.md). Writes S as well.
struct InterfaceLaw {
    InterfaceShape shape;
    Symmetric fit;                       // B^+
    double viscous_coefficient, damping; // c [m2], kappa [1]

    KOKKOS_INLINE_FUNCTION void operator()(const InterfaceSums& sums, double s[3][3], InterfaceStress& out) const {
        double t[3][3], inside[3][3], shear[3]; // T, the gradient as if the liquids were one; the derivative by G
        for (int k = 0; k < 3; ++k) fit.times(sums.n[k], t[k]);
        strain(range_projector(fit), t, s);
        find_shear(sums, t, s, shear);
        for (int k = 0; k < 3; ++k) {
            for (int l = 0; l < 3; ++l) inside[k][l] = 2 * s[k][l];
        }
        add_shear(sums, t, shear, inside, out);
        for (int k = 0; k < 3; ++k) {
            fit.times(inside[k], out.q[k]);
            for (int l = 0; l < 3; ++l)
                out.q[k][l] = viscous_coefficient * (out.q[k][l] - damping * (t[k][l] + shear[k] * shape.normal[l]));
        }
    }

private:
    // t = 2 P S n, of pairs whose tangential velocities part by t (n.x) / f. Takes from G what of it goes with the traction, q n^T of
    // q = P (G + G^T) n, and puts t in its place in S.
    KOKKOS_INLINE_FUNCTION void find_shear(
        const InterfaceSums& sums, double g[3][3], double s[3][3], double shear[3]) const {
        const double* n = shape.normal;
        double q[3], skewed[3], facing[3], more[3];
        times(s, n, q);
        cut(n, q);
        times(g, shape.skew, skewed);
        shape.spread.times(n, facing);
        const double width = inner(n, facing), along = inner(n, shape.skew);
        for (int k = 0; k < 3; ++k) {
            q[k] *= 2;
            more[k] = (sums.sheared[k] - skewed[k] + along * q[k]) / width;
        }
        cut(n, more);
        for (int k = 0; k < 3; ++k) {
            shear[k] = q[k] + more[k];
            for (int l = 0; l < 3; ++l) {
                g[k][l] -= q[k] * n[l];
                s[k][l] += 0.5 * (more[k] * n[l] + n[k] * more[l]);
            }
        }
    }
    KOKKOS_INLINE_FUNCTION void add_shear(const InterfaceSums& sums, const double t[3][3], const double shear[3],
        double inside[3][3], InterfaceStress& out) const {
        const double* n = shape.normal;
        double facing[3], z[3][3], along_normal[3];
        shape.spread.times(n, facing);
        const double width = inner(n, facing), along = inner(n, shape.skew);
        left_over(sums, t, shear, facing, z);
        times(z, n, along_normal);
        for (int k = 0; k < 3; ++k) {
            out.tilted[k] = viscous_coefficient * (1 / width - damping) * shear[k];
            for (int l = 0; l < 3; ++l) {
                const double turned = along * (shear[k] * n[l] + n[k] * shear[l]) - shear[k] * shape.skew[l];
                inside[k][l] += turned / width - damping * (z[k][l] - along_normal[k] * n[l] - n[k] * along_normal[l]);
                out.across[k][l] = -viscous_coefficient * damping * t[k][l];
            }
        }
        cut_columns(n, out.across);
    }
    // Z = sum w f^2 P r x^T, r = (1 + h P) (u - T x) - t (n.x).
    KOKKOS_INLINE_FUNCTION void left_over(const InterfaceSums& sums, const double t[3][3], const double shear[3],
        const double facing[3], double z[3][3]) const {
        for (int k = 0; k < 3; ++k) {
            double plain[3], bent[3];
            shape.spread.times(t[k], plain);
            shape.squares.times(t[k], bent);
            for (int l = 0; l < 3; ++l) {
                z[k][l] =
                    sums.n[k][l] - plain[l] + sums.squares[k][l] - bent[l] - shear[k] * (facing[l] + shape.skew[l]);
            }
        }
        cut_columns(shape.normal, z);
    }
};

} // namespace treacle::sph
