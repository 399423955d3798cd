#pragma once
#include "base/text/vec3.hpp"
#include "sph/iisph/bounded_solve.hpp"
#include "sph/model/step_context.hpp"
#include "sph/pressure/prediction.hpp"
#include "sph/pressure/rigid_coupling_term.hpp"

namespace treacle::sph {

// Implicit incompressible SPH (Ihmsen et al. 2014) without a matrix, in q = p / rho^2:
//     g_i = sum_j m grad W_ij + rho0 sum_s V_s grad W_is
//     a_i = -q_i g_i - sum_j m q_j grad W_ij                    (S8), the walls' share of g_i times Constants::wall_pressure_factor
//     (A q)_i = sum_j m a_j.grad W_ij - a_i.g_i                 minus the density's change by a_i, over dt^2
//     b_i = (rho*_i - rho0) / dt^2
// With (IS1c), correct_gradients.hpp, m B_i grad W_ij stands for m grad W_ij in g_i and (A q)_i, and m B_j grad W_ij in a_i.
// A is G^T G with the q -> a of S8 as G: symmetric and positive semidefinite for any densities, solids included, unless
// walls push harder. Conditions: q >= 0, A q - b >= 0, one of the two zero. With Aim::approach the velocities that
// result are the nearest to u*, by their kinetic energy, of those that compress nothing further: a projection onto a
// convex cone that holds u = 0, which loses energy or keeps it, whatever u* and the step.
class Iisph {
public:
    // gravity [m/s2] determines the solids that bear liquid, for Aim::approach.
    explicit Iisph(const Vec3& gravity = {0, 0, 0}) : gravity_(gravity) {}

    // Source b of the solve.
    //   density:    (rho*_i - rho0) / dt^2
    //   approach:   the same without what the density exceeds rho0 by before the step, liquid within a slack of rho0 counting as full;
    //               of stop: density_error, largest_residual holds for the sums over cells of rows above solids that bear them, with
    //               surface tension for all rows
    //   places:     as density, of a shift of places; largest_residual does not hold
    //   divergence: the density's rate of change over dt; rows with few neighbours (inaccurate density) stay 0 (Bender &
    //               Koschier 2017)
    enum class Aim { density, approach, positions, divergence };
    // Collective: g, the diagonal of A, the gradients of the pairs, corrected where the options say so. Writes the fields
    // packed_position and correction.
    void prepare_pairs(const StepContext& parts);
    // The same, and (S5) b. Ghosts' velocities must be current. Writes the fields source, place, motion.
    void prepare(const StepContext& parts, double dt, Aim aim = Aim::density);

    // A has the response of dynamic bodies as well, until this is called with nullptr. `response` must be that of the
    // present poses.
    void set_coupling_term(const RigidCouplingTerm* response) { response_ = response; }

    // Collective: product() = A q, on owned rows, with q of the owned particles, by gradients of single precision. Writes the
    // fields load, acceleration, motion.
    void multiply(const StepContext& parts, const Array<double>& q);

    // Collective: solves after prepare_pairs(), from half the last pressures, with DFSPH from all of them, with Aim::approach from their best
    // multiple. Writes pressure and role: Poisson where the pressure is positive, Dirichlet elsewhere. With corrected gradients the
    // field acceleration is that by the pressures.
    solve::SolveReport solve(const StepContext& parts, double dt, RoleCounts& roles);

    // (IS2) Collective: what the density would exceed rho0 by after a step dt with the velocities, ghosts' included, as a shift
    // of places: writes -dt G q, A q - b >= 0, to the acceleration field [m/s]. Writes source, load, motion; pressures stay. The
    // particles must stand where they stood at solve() or prepare_pairs().
    solve::SolveReport shift(const StepContext& parts, double dt);

    // Collective: the divergence-free solve of DFSPH. last: the pressures of the last one, in and out [Pa]. Leaves p / rho^2
    // in the field load, ghosts included, for apply_pressure.
    solve::SolveReport solve_divergence(const StepContext& parts, double dt, const Array<double>& last);

    const Array<double>& product() const { return product_; }   // [owned] A q [kg/m3/s2]
    const Array<double>& diagonal() const { return diagonal_; } // [owned] of A, 0 in rows that stay 0 [kg2/m8]
    std::size_t bytes() const;                                  // of this rank [bytes]

private:
    // (IS1c)
    void correct(const StepContext& parts);
    // (S5)
    void write_source(const StepContext& parts, double dt, Aim aim);
    // Solves what prepare() has prepared; last: pressures to start from [owned] [Pa].
    solve::SolveReport iterate(const StepContext& parts, Aim aim, double dt, const Array<double>& last);

    Vec3 gravity_;
    const RigidCouplingTerm* response_ = nullptr;
    Array<double> q_{"treacle::iisph_q", 0};
    Array<double> product_{"treacle::iisph_product", 0};
    Array<double> diagonal_{"treacle::iisph_diagonal", 0};
    Array<double> watched_{"treacle::iisph_watched", 0}; // 1 in rows for which largest_residual holds, else 0
    Array<float> gradient_[3] = {Array<float>("treacle::iisph_gradient_x", 0),
        Array<float>("treacle::iisph_gradient_y", 0),
        Array<float>("treacle::iisph_gradient_z", 0)}; // m grad W of each pair [kg/m^(D+1)]
    Array<float> adjoint_[3];             // m B_j grad W of each pair: the same arrays unless gradients are corrected
    Array3 own_{"treacle::iisph_own", 0}; // g
    Array3 force_{"treacle::iisph_force", 0}; // g of the forces: the same array unless walls push harder
    Array<double> pressed_{"treacle::iisph_pressed", 0},
        answered_{"treacle::iisph_answered", 0}; // with the bodies' response
    SpectralGradient spectral_;
    double weight_ = 0; // of Jacobi; 0: not known yet
};

// Number of neighbours within the support on the lattice of rest.
int lattice_neighbours(const Constants& constants);

// omega: the option's, or 0.5 where an endless lattice lets it converge with a margin for disorder, or less.
double iisph_weight(const SphOptions& options, const Constants& constants);

} // namespace treacle::sph
