#pragma once
// Inside viscous_multilevel: what a cell with a velocity at each corner, linear along each axis between them, resists with.
#include "kokkos/float4.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace treacle::sph {

template <int D>
inline constexpr int corners = 1 << D; // bit k of a corner's number: on the upper side along axis k

// Energies of the velocity gradient g: |g|^2 and g : g^T, with these factors.
struct GradientEnergy {
    double square = 1, transposed = 1; // [1]
};

// The matrix of an energy, E = u.K u / 2 with the mean over the cell, in the basis of the modes c_m = sum over corners of
// +-u, the sign that of the product of the coordinates whose bits m has: it is nearly diagonal there, and to go there and
// back takes additions alone. All numbers have the factor 4^-D in them, and lengths are in widths along the first axis.
template <int D>
class Element {
public:
    Element() = default;
    Element(const GradientEnergy& energy, const double width[3]) {
        const double all = 1.0 / (corners<D> * corners<D>);
        const auto scale = [&](int k, int l) { return 4 * all * width[0] * width[0] / (width[k] * width[l]); };
        for (int m = 0; m < corners<D>; ++m) {
            double third = 3, slopes = 0; // 3^(1 - axes of m)
            for (int l = 0; l < D; ++l) {
                if (!(m >> l & 1)) continue;
                third /= 3;
                slopes += energy.square * scale(l, l);
            }
            for (int k = 0; k < 4; ++k) {
                const bool along = k < D && (m >> k & 1);
                diagonal_[m][k] = m > 0 && k < D ? static_cast<float>(
                                                       third * (slopes + (along ? energy.transposed * scale(k, k) : 0)))
                                                 : 0;
            }
        }
        for (int k = 0; k < D; ++k) {
            for (int l = 0; l < D; ++l) cross_[k][l] = k == l ? 0 : static_cast<float>(energy.transposed * scale(k, l));
        }
    }

    // u, the corners' velocities, becomes the forces that hold them.
    KOKKOS_INLINE_FUNCTION void apply(Float4 u[corners<D>]) const {
        walsh_hadamard(u, [](Float4& low, Float4& high) { // to the modes
            const Float4 difference = high - low;
            low = low + high;
            high = difference;
        });
        float c[corners<D>][4];
        for (int m = 0; m < corners<D>; ++m) {
            u[m].store(c[m]);
            u[m] = u[m] * Float4::load(diagonal_[m]);
        }
        if constexpr (D == 2) {
            u[1] = u[1] + Float4::of(0, cross_[0][1] * c[2][0], 0);
            u[2] = u[2] + Float4::of(cross_[1][0] * c[1][1], 0, 0);
        } else {
            u[1] = u[1] + Float4::of(0, cross_[0][1] * c[2][0], cross_[0][2] * c[4][0]);
            u[2] = u[2] + Float4::of(cross_[1][0] * c[1][1], 0, cross_[1][2] * c[4][1]);
            u[4] = u[4] + Float4::of(cross_[2][0] * c[1][2], cross_[2][1] * c[2][2], 0);
            constexpr float third = 1.0f / 3;
            u[6] = u[6] + Float4::of(third * (cross_[1][0] * c[5][1] + cross_[2][0] * c[3][2]), 0, 0);
            u[5] = u[5] + Float4::of(0, third * (cross_[2][1] * c[3][2] + cross_[0][1] * c[6][0]), 0);
            u[3] = u[3] + Float4::of(0, 0, third * (cross_[0][2] * c[6][0] + cross_[1][2] * c[5][1]));
        }
        walsh_hadamard(u, [](Float4& without, Float4& with) { // and back to the corners
            const Float4 sum = without + with;
            without = without - with;
            with = sum;
        });
    }

    static constexpr int unknowns = corners<D> * D; // by corner and component
    // K in the basis of the corners' components, D a + k of corner a along axis k; for the bound of its eigenvalues.
    using Matrix = Eigen::Matrix<double, unknowns, unknowns>;
    Matrix matrix() const {
        Matrix out;
        for (int b = 0; b < unknowns; ++b) {
            Float4 u[corners<D>];
            for (int a = 0; a < corners<D>; ++a) {
                const auto unit = [&](int k) { return b == D * a + k ? 1.0f : 0.0f; };
                u[a] = Float4::of(unit(0), unit(1), D > 2 ? unit(2) : 0.0f);
            }
            apply(u);
            for (int a = 0; a < corners<D>; ++a) {
                float force[4];
                u[a].store(force);
                for (int k = 0; k < D; ++k) out(D * a + k, b) = static_cast<double>(force[k]);
            }
        }
        return out;
    }

private:
    // combine(lower, upper) of all pairs along one axis after the other.
    template <class Combine>
    KOKKOS_INLINE_FUNCTION static void walsh_hadamard(Float4 u[corners<D>], const Combine& combine) {
        for (int k = 0; k < D; ++k) {
            for (int a = 0; a < corners<D>; ++a) {
                if (!(a >> k & 1)) combine(u[a], u[a | 1 << k]);
            }
        }
    }

    float diagonal_[corners<D>][4]{};
    float cross_[3][3]{};
};

// The largest eigenvalue of a cell with its diagonal blocks' inverses, or 1, that of masses: none of a sum of cells is larger.
template <int D>
double largest_eigenvalue(const typename Element<D>::Matrix& matrix) {
    typename Element<D>::Matrix blocks = Element<D>::Matrix::Zero();
    for (int a = 0; a < corners<D>; ++a)
        blocks.template block<D, D>(D * a, D * a) = matrix.template block<D, D>(D * a, D * a);
    const Eigen::GeneralizedSelfAdjointEigenSolver<typename Element<D>::Matrix> solver(
        matrix, blocks, Eigen::EigenvaluesOnly);
    return std::max(1.0, solver.eigenvalues().maxCoeff());
}

} // namespace treacle::sph
