#pragma once
#include "sph/iisph/iisph.hpp"

namespace treacle::sph {

// Arrays of the pairs' gradients in the order of the list, and what the operator A takes of each row.
struct CorrectedGradients {
    std::array<Array<float>, 3> own;     // in: m grad W_ij; out: m B_i grad W_ij [kg/m4]
    std::array<Array<float>, 3> adjoint; // out: m B_j grad W_ij
    Array3 sum;                          // [owned][3] out: g [kg/m4]
    Array<double> diagonal;              // [owned] out: of A [kg2/m8]
};

// (IS1c) Collective. Finds B of all particles, ghosts included, and corrects the gradients:
//     M_i = -(sum_j V0 grad W_ij x_ij^T + sum_s V_s grad W_is d_is n_s^T), symmetric part, d_is the height over the solid's surface
//     B_i = (1 - s) 1 + s M_i^-1, s from 0 to 1 with the smallest eigenvalue of M_i, less beside solids
// The divergence sum_j m u_ij.B_i grad W_ij is then exact for linear velocities that solids let through (Bonet & Lok 1999), and
// 0 for rotations whatever s: the forces, its adjoint, keep the momentum and the angular momentum.
void correct_gradients(const StepContext& parts, const CorrectedGradients& gradients);

} // namespace treacle::sph
