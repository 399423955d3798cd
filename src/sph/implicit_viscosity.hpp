#pragma once
#include "solve/krylov.hpp"
#include "sph/rigid_blocks.hpp"
#include "sph/viscous_bodies.hpp"
#include "sph/viscous_operator.hpp"

namespace treacle::sph {

class Bodies;

// Implicit viscosity (dissertation, chapter 4): C u = u* by conjugate gradients on the device, from u* on, with dynamic
// bodies as unknowns of the same system; again with the viscosities that the velocities bring, where these depend on the
// shear rate.
class ImplicitViscosity {
public:
    // Friction and slip length per solid and flow curves per liquid, as in ForceOptions.
    ImplicitViscosity(const Comm& comm, LiquidParticles& liquid, const ViscosityOptions& options, const CellGrid& grid,
                      const std::vector<double>& friction, const std::vector<double>& slip_lengths = {},
                      const std::vector<FlowCurve>& rheology = {});

    struct Result {
        solve::SolveReport solve;
        BodyLoads loads; // this rank's share of what the liquid puts on the solids [N], [N m]
    };
    // Collective: changes the owned particles' velocities, u* before and u after a step of dt [s]. The ghosts' are left
    // stale. An unsuccessful solve is a report, with the last iterate. The bodies stay as they are, also those that the
    // solve moved: they come to the velocities of its solution by the loads.
    Result solve(const ViscousScene& scene, const Bodies& bodies, double dt);

    const ViscousOperator& system() const { return operator_; }
    std::size_t bytes() const { return operator_.bytes() + (blocks_ ? blocks_->bytes() : 0) + 8 * 3 * (residual_.extent(0) + scaled_.extent(0) + product_.extent(0)); }

private:
    // Of the conjugate gradients, what bodies have in the place of the particles' arrays.
    struct BodyVectors {
        std::vector<double> q, residual, scaled, direction;
    };
    void solve_by_rates(const ViscousParts& parts, const Bodies& bodies, double dt, Result& result);
    solve::SolveReport iterate(const ViscousParts& parts, const Bodies& bodies, const Array3& before, double enough);
    double multiply(const ViscousParts& parts, std::vector<double>& body_product);
    double precondition(const LiquidParticles& liquid);
    std::vector<double> pull(const ViscousParts& parts);

    ViscousOperator operator_;
    std::unique_ptr<RigidBlocks> blocks_; // null: the diagonal blocks alone precondition
    ViscousBodies movers_;
    BodyVectors body_;
    Array<double> friction_;
    Array<FlowCurve> rheology_{"treacle::flow_curves", 0};
    double dt_ = 0;
    int direction_ = -1; // field
    Array3 residual_{"treacle::viscous_residual", 0}, scaled_{"treacle::viscous_scaled", 0},
        product_{"treacle::viscous_product", 0}, before_{"treacle::velocity_before", 0};
};

} // namespace treacle::sph
