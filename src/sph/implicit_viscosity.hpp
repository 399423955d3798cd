#pragma once
#include "solve/krylov.hpp"
#include "sph/rigid_blocks.hpp"
#include "sph/viscous_operator.hpp"
namespace treacle::sph {

class Bodies;

// Implicit viscosity (dissertation, chapter 4): C u = u* by conjugate gradients on the device, from u* on.
class ImplicitViscosity {
public:
    // Friction per solid, as ForceOptions::friction.
    ImplicitViscosity(const Comm& comm, LiquidParticles& liquid, const ViscosityOptions& options, const CellGrid& grid,
                      const std::vector<double>& friction);

    struct Result {
        solve::SolveReport solve;
        BodyLoads loads; // this rank's share of what the liquid puts on the solids [N], [N m]
    };
    // Collective: changes the owned particles' velocities, u* before and u after a step of dt [s]. The ghosts' are left
    // stale. An unsuccessful solve is a report, with the last iterate.
    Result solve(const ViscousScene& scene, const Bodies& bodies, double dt);

    const ViscousOperator& system() const { return operator_; }
    std::size_t bytes() const { return operator_.bytes() + (blocks_ ? blocks_->bytes() : 0) + 8 * 3 * (residual_.extent(0) + scaled_.extent(0) + product_.extent(0)); }

private:
    void upload_motion(const Bodies& bodies);
    solve::SolveReport iterate(const ViscousParts& parts);
    double precondition(const LiquidParticles& liquid);

    ViscousOperator operator_;
    std::unique_ptr<RigidBlocks> blocks_; // null: the diagonal blocks alone precondition
    Array<double> friction_;
    Array<double> motion_{"treacle::solid_motion", 0};
    int direction_ = -1; // field
    Array3 residual_{"treacle::viscous_residual", 0}, scaled_{"treacle::viscous_scaled", 0},
        product_{"treacle::viscous_product", 0};
};

} // namespace treacle::sph
