#pragma once
// Private to src/rigid.
#include <Eigen/Core>

#include <vector>

namespace treacle::rigid {

// Impulses at contacts that press and rub. An impulse l_r along row r gives the others the velocities G G^T l; there are three
// rows a contact, the normal and two tangents at right angles to each other.
struct FrictionProblem {
    Eigen::MatrixXd rows;         // G [3 contacts][independent motions], zero where nothing moves
    Eigen::VectorXd velocity;     // [3 contacts] without impulses
    Eigen::VectorXd wanted;       // [contacts] least velocity along the normal
    std::vector<double> friction; // [contacts]
};

// Impulses l with: at each contact l_n >= 0, u_n >= target, l_n (u_n - target) = 0, |l_t| <= friction l_n, and where it
// slides (u_t not 0) l_t is against u_t and of that size. Velocities are right to `tolerance`, where such impulses
// exist.
//
// Projected Gauss-Seidel determines which contacts touch, stick and slide; the linear system of that is solved directly
// (regularised, with multipliers that take the regularisation back) and corrects these states, until none changes. So
// the ratio of masses and the height of stacks do not matter. Solutions of the linear system count when they are nearer
// to the conditions.
Eigen::VectorXd solve_friction(const FrictionProblem& problem, double tolerance);

} // namespace treacle::rigid
