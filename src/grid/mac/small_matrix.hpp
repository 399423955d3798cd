#pragma once
#include "kokkos/types.hpp"

namespace treacle::grid {

// Products and inverses of 3 x 3 matrices, for kernels.
struct SmallMatrix {
    double at[3][3]{}; // [row][column]

    static KOKKOS_INLINE_FUNCTION SmallMatrix identity_plus(double factor, const SmallMatrix& a) { // I + factor a
        SmallMatrix out;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) out.at[i][j] = factor * a.at[i][j] + (i == j ? 1.0 : 0.0);
        }
        return out;
    }
    // Sum of the squares of all entries.
    KOKKOS_INLINE_FUNCTION double squares() const {
        double sum = 0;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) sum += at[i][j] * at[i][j];
        }
        return sum;
    }
    // Sum of the squares of the symmetric part.
    KOKKOS_INLINE_FUNCTION double strain_squares() const {
        double sum = 0;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) sum += 0.25 * (at[i][j] + at[j][i]) * (at[i][j] + at[j][i]);
        }
        return sum;
    }
    KOKKOS_INLINE_FUNCTION SmallMatrix times(const SmallMatrix& b) const {
        SmallMatrix out;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j)
                out.at[i][j] = at[i][0] * b.at[0][j] + at[i][1] * b.at[1][j] + at[i][2] * b.at[2][j];
        }
        return out;
    }
    KOKKOS_INLINE_FUNCTION SmallMatrix inverse() const {
        SmallMatrix out;
        double determinant = 0;
        for (int i = 0; i < 3; ++i) {
            const int p = (i + 1) % 3, q = (i + 2) % 3;
            for (int j = 0; j < 3; ++j) {
                const int r = (j + 1) % 3, s = (j + 2) % 3;
                out.at[j][i] = at[p][r] * at[q][s] - at[p][s] * at[q][r];
            }
            determinant += at[i][0] * out.at[0][i];
        }
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) out.at[i][j] /= determinant;
        }
        return out;
    }
};

// Fraction of a motion that a step along straight lines does not resolve: paths cross where dt times the size of the
// velocity gradient comes near one. From `resolved` on they bend along the velocities of the faces, at twice that in
// full. Sizes are roots of the sum of all squares; a turn, which makes no paths cross, counts less.
KOKKOS_INLINE_FUNCTION double bending_weight(const SmallMatrix& gradient, double dt) {
    constexpr double resolved = 0.5, rotation_weight = 0.6;
    const double strain = gradient.strain_squares(), turn = math::max(0.0, gradient.squares() - strain);
    return math::max(0.0, math::min(1.0, dt * math::sqrt(strain + rotation_weight * turn) / resolved - 1));
}

// The velocity gradient after particles have moved by dt along straight lines with the gradient g before: g (I + dt g)^-1. Where
// that strains by more than `most_strain` the change is that of a shorter step, so that the inverse is there.
KOKKOS_INLINE_FUNCTION SmallMatrix carried_gradient(const SmallMatrix& g, double dt) {
    constexpr double most_strain = 0.5;
    const double strain = math::fabs(dt) * math::sqrt(g.strain_squares());
    const double fraction = strain > most_strain ? most_strain / strain : 1.0;
    return g.times(SmallMatrix::identity_plus(fraction * dt, g).inverse());
}

} // namespace treacle::grid
