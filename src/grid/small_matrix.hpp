#pragma once
#include "kokkos/types.hpp"

namespace treacle::grid {

// Products and inverses of 3 x 3 matrices, for kernels.
struct SmallMatrix {
    double at[3][3]{};

    static KOKKOS_INLINE_FUNCTION SmallMatrix identity_plus(double factor, const SmallMatrix& a) {
        SmallMatrix out;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) out.at[i][j] = factor * a.at[i][j] + (i == j ? 1.0 : 0.0);
        }
        return out;
    }
    KOKKOS_INLINE_FUNCTION double squares() const {
        double sum = 0;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) sum += at[i][j] * at[i][j];
        }
        return sum;
    }
    KOKKOS_INLINE_FUNCTION SmallMatrix times(const SmallMatrix& b) const {
        SmallMatrix out;
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) out.at[i][j] = at[i][0] * b.at[0][j] + at[i][1] * b.at[1][j] + at[i][2] * b.at[2][j];
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

// The velocity gradient after particles have moved by dt along straight lines with the gradient g before: g (I + dt g)^-1.
// Where dt g is above `most_turn` a step does not resolve it, and the change is that of a shorter step.
KOKKOS_INLINE_FUNCTION SmallMatrix carried_gradient(const SmallMatrix& g, double dt) {
    constexpr double most_turn = 0.5;
    const double turn = math::fabs(dt) * math::sqrt(g.squares());
    const double share = turn > most_turn ? most_turn / turn : 1.0;
    return g.times(SmallMatrix::identity_plus(share * dt, g).inverse());
}

} // namespace treacle::grid
