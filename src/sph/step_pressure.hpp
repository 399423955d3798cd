#pragma once
#include "base/timers.hpp"
#include "sph/forces/inflow.hpp"
#include "sph/iisph/iisph.hpp"
#include "sph/iisph/orthomin_correction.hpp"
#include "sph/model/step_context.hpp"
#include "sph/pressure/complementarity.hpp"
#include "sph/pressure/pressure_hierarchy.hpp"
#include "sph/pressure/pressure_system.hpp"
#include "sph/pressure/rigid_coupling_term.hpp"
#include "sph/solids/bodies.hpp"
#include "sph/step_report.hpp"

#include <functional>
#include <memory>

namespace treacle::sph {

// Parts of a step that its pressures read and write.
struct PressureParts {
    StepContext step;
    SolidParticles& solid; // as unknowns
    Halo& solid_halo;
    const CellGrid& grid;
    const CellList& solid_cells;
    Bodies& bodies;
    const Inflow* inflow; // or none
    PhaseTimers& timers;
};

// The pressures of a step, by the solver of `method.pressure.solver`: the system (S5)-(S7), IISPH (IS1), or DFSPH. Solves that
// fail throw SimulationError on every rank.
class StepPressure {
public:
    StepPressure(const Comm& comm, const SphOptions& options, const Constants& constants, const DomainBox& domain,
        const CellGrid& grid, const Vec3& gravity);

    // The fields that the solver keeps from step to step; once, before there are particles.
    void add_fields(LiquidParticles& liquid);
    // The particles have pressures of a last step, as from a checkpoint, or have none.
    void start(LiquidParticles& liquid, LastPressures last);

    // (S5)-(S7) or (IS1): writes pressures and roles. Velocities and pressures of ghosts must be current. Collective.
    void solve(const PressureParts& parts, StepReport& report, double dt);
    // The divergence-free solve of DFSPH: of the last step, at the places that it led to. Changes velocities and adds to the loads
    // of solids; nothing with other solvers. Collective.
    void remove_divergence(const PressureParts& parts, StepReport& report, double dt);
    // (IS2) Particles where the velocities leave liquid that is compressed move on by more than their velocities: writes the
    // difference to the acceleration field [m/s]. Collective.
    void shift(
        const StepContext& parts, const MomentReferencePoints& moment_reference_points, StepReport& report, double dt);
    // For a shift() without a solve() before it.
    void prepare_shift(const StepContext& parts) { iisph_.prepare_pairs(parts); }

    // Called with the pressure matrix of every step before its solve, outside of all phases. IISPH has none.
    using MatrixObserver = std::function<void(solve::Matrix&)>;
    void observe_matrix(MatrixObserver observer) { matrix_observer_ = std::move(observer); }
    const PressureSystem& system() const { return system_; }
    std::size_t bytes() const;

private:
    void find_by_system(const PressureParts& parts, StepReport& report, double dt);
    void find_by_iisph(const PressureParts& parts, StepReport& report, double dt);
    void predict_roles(const PressureParts& parts, StepReport& report, double dt);
    void find_around_solids(const PressureParts& parts);
    void assemble(const PressureParts& parts);
    solve::ConvergenceTest convergence_test(const StepReport& report, double dt) const;
    void solve_system(const StepContext& parts, solve::Matrix& matrix, const PressureSystem::HostSystem& host,
        StepReport& report, double dt);
    void correct(const StepContext& parts, solve::Matrix& matrix, StepReport& report, double dt);
    ComplementarityContext complementarity_parts(const StepContext& parts);

    Comm comm_;
    SphOptions options_;
    Constants constants_;
    PressurePinning pinning_;
    PressureSystem system_;
    SolidRows solid_rows_; // of solids as unknowns
    Iisph iisph_;          // or the operator of the corrections
    OrthominCorrection correction_;
    RigidCouplingTerm response_;
    std::unique_ptr<PressureHierarchy> hierarchy_; // of the multilevel preconditioners
    solve::KrylovSolver solver_;
    Complementarity complementarity_; // with `dirichlet: complementarity` in its place
    int divergence_field_ = -1;       // of the liquid, with DFSPH: the pressures of the last divergence-free solve [Pa]
    LastPressures last_pressures_ = LastPressures::known;
    MatrixObserver matrix_observer_;
};

// True when solid particles have pressures of their own as unknowns.
bool solids_unknown(const SphOptions& options);

} // namespace treacle::sph
