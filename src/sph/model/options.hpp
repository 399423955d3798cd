#pragma once
#include "solve/multigrid/smoother.hpp"
#include "sph/model/kernels.hpp"

namespace treacle {
class Declaration;
}

namespace treacle::sph {

// Kernel of the density (S1)-(S3).
enum class DensityKind { blended, smooth, spiky };
// Particles with p = 0 (S6), by the table of Dirichlet rules in README.md.
enum class DirichletRule { predicted, source, density, predicted_density, surface, ghosts, complementarity };
// Clamping at 0: of the pressures that a solve has found, or of its sources.
enum class Clamping { pressures, sources };
// Part of solids in the pressure system: none, Eq. 2.10, 3.2, 3.3, exact Neumann source, pressures of their own.
enum class SolidTerm { none, decomposed, unified, amplified, exact, unknowns };
// Pressure force of walls (S8): by the liquid's pressure, or times the factor that balances it at rest.
enum class WallForce { one_sided, balanced };
// Particles that would sink below a solid's surface within a step (S8c).
enum class WallContact { stop, none };
// Bodies in a solve: unknowns of it, or at rest until their loads are known.
enum class BodyCoupling { strong, weak };
// End of the pressure iterations: mean compression, or relative residual.
enum class StoppingRule { density_error, residual };
// Return of compressed liquid to its density: by velocities, or by a position shift (IS2).
enum class DensityRecovery { automatic, velocities, positions };
// Gradients of pressures (IS1c): automatic: corrected where solids can move the liquid.
enum class PressureGradients { automatic, kernel, corrected };
// Pressure solver of a step.
enum class PressureSolver { isph, iisph, iisph_jacobi, dfsph };
// Preconditioner of the pressure system (S7).
enum class PressurePreconditioner {
    none,
    jacobi,
    incomplete_cholesky,
    ssor,
    sor_jacobi, // the dissertation's SORCG, 3.6
    gamg,
    boomeramg,
    multilevel,              // Galerkin products on cells (src/solve/README.md)
    multilevel_rediscretised // the dissertation's grids, 3.5
};
// Integration of the viscous force in time.
enum class ViscosityIntegration {
    automatic,
    implicit,
    explicit_pairs, // Monaghan & Cleary's, with the other forces
    explicit_form   // one product with the operator of the form
};
// Discrete viscous force (S4v), by the table of forms in README.md.
enum class ViscosityForm {
    corrected,   // the adjoint form of exact gradients: rotations stay what they are
    adjoint,     // the symmetric form of section 4.4
    pairwise,    // Weiler et al. 2018
    laplacian,   // Brookshaw 1985, component by component
    as_published // equations 4.5-4.12, not symmetric
};
// Preconditioner of the viscous system.
enum class ViscosityPreconditioner {
    jacobi,     // the diagonal 3 x 3 blocks
    multilevel, // and multigrid over cells, matrix-free
    gamg,       // of the assembled matrix
    boomeramg
};
// Krylov method of the viscous system; bicgstab is PETSc's, of the assembled matrix.
enum class ViscositySolver { conjugate_gradients, bicgstab };
// Numbers of the matrix-free products; the residual that ends a solve is in double precision.
enum class ViscosityPrecision { full, mixed };
// First iterate of the viscous solve: u*, or u* and the last solve's change.
enum class ViscosityGuess { velocity, last_change };
// Force of surface tension (S4t).
enum class SurfaceTensionModel {
    none,
    cohesion, // Becker & Teschner 2007
    curvature // Morris 2000
};
// Options of the block `density` (S1)-(S3).
struct DensityOptions {
    DensityKind kind = DensityKind::smooth; // blended is the dissertation's (src/sph/measurements.md)
    double blend_from = 5; // alpha of Eq. 2.3: wall neighbours below which the smooth kernel rules alone
    double blend_to = 15;  // beta: from which the spiky kernel rules alone

    // Share of the spiky kernel's density at a number of solid neighbours (zeta of Eq. 2.3).
    KOKKOS_INLINE_FUNCTION double spiky_weight(double wall_neighbours) const {
        if (kind != DensityKind::blended) return kind == DensityKind::spiky ? 1.0 : 0.0;
        return math::min(math::max((wall_neighbours - blend_from) / (blend_to - blend_from), 0.0), 1.0);
    }
    void declare(Declaration& d);
};

// Options of the multilevel preconditioners.
struct MultilevelOptions {
    double cell = 0;             // width of the finest cells in spacings; 0: the neighbour search's
    double overcorrection = 1.6; // what coarse matrices are divided by
    solve::Smoother smoother = solve::default_smoother();
    double jacobi_weight = 2.0 / 3; // above 0, at most 1
    solve::Cycle cycle = solve::Cycle::w;
    int coarse_sweeps = 1;
    double grid_factor = 1.2; // lambda of the dissertation

    void declare(Declaration& d); // keys of `multilevel`
};

// Options of the block `pressure`, relative tolerances among them.
struct PressureOptions {
    PressureSolver solver = PressureSolver::iisph;
    double jacobi_weight =
        0; // omega of IISPH and DFSPH; 0: the published 0.5, or less where that diverges (src/sph/theory.md)
    DirichletRule dirichlet = DirichletRule::predicted;
    double prediction = 1;         // gamma of Eq. 2.6; the dissertation's 0.5 is noisier (src/sph/measurements.md)
    double surface_density = 0.97; // of the rest density, below which `density` and `predicted_density` mark a surface
    Clamping clamping = Clamping::pressures;
    SolidTerm solid_term = SolidTerm::exact;
    double amplification_limit =
        2; // gamma of Eq. 3.3; the dissertation's 5 ejects lone particles (src/sph/measurements.md)
    WallForce wall_force = WallForce::one_sided;
    WallContact wall_contact = WallContact::stop;
    BodyCoupling coupling = BodyCoupling::strong;
    PressurePreconditioner preconditioner = PressurePreconditioner::multilevel;
    double relaxation = 1; // omega of ssor and sor_jacobi
    MultilevelOptions multilevel;
    StoppingRule stop = StoppingRule::density_error;
    double density_error =
        0; // mean compression of the Poisson particles, share of the rest density; 0: density_tolerance()
    DensityRecovery recovery = DensityRecovery::automatic; // by what compressed liquid gets its density back
    PressureGradients gradients = PressureGradients::automatic;
    double divergence_error = 1e-4; // of DFSPH: mean compression that the velocities would cause in a step
    double largest_residual =
        0; // relative, that the density rule must reach as well (src/sph/theory.md); 0: residual_tolerance()
    double residual = 1e-6;    // relative, for the residual rule
    int corrections = 0;       // most of a step (orthomin_correction.hpp)
    int max_iterations = 2000; // of one solve; beyond: SimulationError

    // Tolerances for the two that are 0: with positions, pressures of the first solve gather no density error.
    double density_tolerance() const { return density_error > 0 ? density_error : recovers_positions() ? 1e-3 : 1e-5; }
    double residual_tolerance() const {
        return largest_residual > 0 ? largest_residual : recovers_positions() ? 0.05 : 0.1;
    }
    // True where gradients can be corrected: the operator is then the solver's own.
    bool may_correct_gradients() const {
        return recovers_positions() && solver == PressureSolver::iisph && wall_force == WallForce::one_sided;
    }
    bool corrects_gradients() const { return gradients == PressureGradients::corrected; }
    bool recovers_positions() const {
        return recovery == DensityRecovery::positions ||
               (recovery == DensityRecovery::automatic && solver == PressureSolver::iisph);
    }

    void declare(Declaration& d); // keys of `pressure`

private:
    void declare_solver(Declaration& d);
    void declare_roles(Declaration& d);
    void declare_solids(Declaration& d);
    void declare_preconditioner(Declaration& d);
    void declare_stop(Declaration& d);
    void check_complementarity(Declaration& d) const;
    void check_solver(Declaration& d) const;
};

// Options of the block `viscosity`.
struct ViscosityOptions {
    ViscosityIntegration integration = ViscosityIntegration::automatic;
    ViscosityForm form = ViscosityForm::corrected;
    double hourglass_coefficient = 1; // kappa of the corrected form (src/sph/theory.md)
    double support_ratio = 2.2;       // of the corrected form's sums, h / d
    bool assembled = false;           // the matrix with its second ring, in place of products without one
    ViscositySolver solver = ViscositySolver::conjugate_gradients;
    ViscosityPreconditioner preconditioner = ViscosityPreconditioner::multilevel;
    ViscosityGuess guess = ViscosityGuess::velocity;
    ViscosityPrecision precision = ViscosityPrecision::mixed;
    double residual = 1e-6;    // relative
    int max_iterations = 5000; // of one solve; beyond: SimulationError
    BodyCoupling coupling = BodyCoupling::strong;
    double picard_residual = 0.01; // relative, with the viscosities of the velocities that were found
    int max_picard_iterations = 4; // most in a step, when viscosities depend on the shear rate
    double artificial = 0.2;       // Monaghan's alpha
    double reference_speed = 0;    // [m/s]; 0: sqrt(g H) of the initial liquid
    double bulk = 4;               // zeta / mu of liquid that is stretched
    double xsph = 0;               // share of the neighbours' mean velocity that moves a particle

    void declare(Declaration& d); // keys of `viscosity`

private:
    void declare_form(Declaration& d);
    void declare_solver(Declaration& d);
    void declare_others(Declaration& d);
};

// Options of the block `surface_tension`.
struct SurfaceTensionOptions {
    SurfaceTensionModel model = SurfaceTensionModel::none;

    void declare(Declaration& d); // keys of `surface_tension`
};

// Options of hybrid incompressible SPH (dissertation, chapter 2), as the block `method` of a scene gives them.
struct SphOptions {
    KernelKind kernel = KernelKind::cubic_spline;
    double support_ratio = 2.5; // h / d
    DensityOptions density;
    PressureOptions pressure;
    ViscosityOptions viscosity;
    SurfaceTensionOptions surface_tension;
    double max_load_imbalance = 1.15; // largest over mean load of the ranks

    void declare(Declaration& d); // keys of `method`
};

} // namespace treacle::sph
