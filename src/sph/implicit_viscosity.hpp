#pragma once
#include "solve/krylov.hpp"
#include "sph/rigid_blocks.hpp"
#include "sph/viscous_matrix.hpp"
#include "sph/viscous_operator.hpp"

#include <memory>
#include <optional>

namespace treacle::sph {

class Bodies;

// Viscosity by the operator of a form (dissertation, chapter 4): implicit, C u = u*, by conjugate gradients on the device
// from u* on, or with the assembled matrix; or explicit, u = u* + dt/m f(u*).
class ImplicitViscosity {
public:
    // Friction per solid, as ForceOptions::friction.
    ImplicitViscosity(const Comm& comm, LiquidParticles& liquid, const ViscosityOptions& options, const CellGrid& grid,
                      const std::vector<double>& friction);

    // No particle has been through a step: what the last solve changed is nothing. Before the first step of a run.
    void start(const LiquidParticles& liquid);

    struct Result {
        solve::SolveReport solve;
        BodyLoads loads; // this rank's share of what the liquid puts on the solids [N], [N m]
    };
    // Collective: changes the owned particles' velocities, u* before and u after a step of dt [s]. The ghosts' are left
    // stale. An unsuccessful solve is a report, with the last iterate.
    Result solve(const ViscousScene& scene, const Bodies& bodies, double dt);

    // Of the last solve; null where none is assembled.
    const solve::Matrix* matrix() { return matrix_ ? matrix_->matrix() : nullptr; }
    std::size_t bytes() const;

private:
    // C u = u* as it goes: the report, and the norm that the residual is a share of.
    struct Progress {
        const ViscousParts& parts;
        solve::SolveReport report{};
        double norm = 0;
        bool ended(double square);
    };
    void upload_motion(const Bodies& bodies);
    void set_up(Progress& progress);
    bool start_from_last_change(Progress& progress, double square);
    void keep_change(const LiquidParticles& liquid);
    void iterate(Progress& progress);
    void solve_assembled(Progress& progress);
    solve::SolveReport solve_implicitly(const ViscousParts& parts);
    solve::SolveReport step_explicitly(const ViscousParts& parts);
    void precondition(const LiquidParticles& liquid, const Array3& r, const Array3& z);

    ViscousOperator operator_;
    std::unique_ptr<RigidBlocks> blocks_; // null: the diagonal blocks alone precondition
    std::optional<ViscousMatrix> matrix_; // empty: products without a matrix
    Array<double> friction_;
    Array<double> motion_{"treacle::solid_motion", 0};
    int direction_ = -1;   // field
    int last_change_ = -1; // field, where the guess is made of it [m/s]
    Array3 residual_{"treacle::viscous_residual", 0}, scaled_{"treacle::viscous_scaled", 0},
        product_{"treacle::viscous_product", 0}, before_{"treacle::viscous_before", 0};
};

} // namespace treacle::sph
