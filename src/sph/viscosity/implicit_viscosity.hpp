#pragma once
#include "solve/krylov/krylov.hpp"
#include "sph/viscosity/multigrid/viscous_multilevel.hpp"
#include "sph/viscosity/operator/near_pairs.hpp"
#include "sph/viscosity/operator/viscous_bodies.hpp"
#include "sph/viscosity/operator/viscous_matrix.hpp"
#include "sph/viscosity/operator/viscous_operator.hpp"

#include <optional>

namespace treacle::sph {

class Bodies;

// Viscosity by the operator of a form (dissertation, chapter 4): implicit, C u = u*, by conjugate gradients on the device
// from u* on, with dynamic bodies as unknowns of the same system, or with the assembled matrix; again with the viscosities
// that the velocities bring, where these depend on the shear rate; or explicit, u = u* + dt/m f(u*).
class ImplicitViscosity {
public:
    // Friction and slip length per solid and flow curves per liquid, as in ForceOptions.
    ImplicitViscosity(const Comm& comm, LiquidParticles& liquid, const ViscosityOptions& options, const CellGrid& grid,
        const std::vector<double>& friction, const std::vector<double>& slip_lengths = {},
        const std::vector<flow::ViscosityModel>& rheology = {});

    // No particle has been through a step: what the last solve changed is nothing. Before the first step of a run.
    void start(const LiquidParticles& liquid);

    // Result of one solve.
    struct Result {
        solve::SolveReport solve;
        BodyLoads loads; // this rank's share of what the liquid puts on the solids [N], [N m]
    };
    // Collective: changes the owned particles' velocities, u* before and u after a step of dt [s]. The ghosts' are left
    // stale. An unsuccessful solve is a report, with the last iterate. The bodies stay as they are, also those that the
    // solve moved: they come to the velocities of its solution by the loads.
    Result solve(const ViscousScene& step, const Bodies& bodies, double dt);

    // Matrix of the last solve; null where none is assembled.
    const solve::Matrix* matrix() { return matrix_ ? matrix_->matrix() : nullptr; }
    std::size_t bytes() const;

private:
    // C u = before as it goes: the report, and the norm that the residual is a share of.
    struct Progress {
        const ViscousContext& parts;
        const Bodies& bodies;
        const Array3& before; // u*
        double enough = 0;    // relative residual of the present velocities that spares all iterations
        bool first = true;    // solve of the step
        solve::SolveReport report{};
        double norm = 0;
        bool ended(double square);
    };
    // Vectors of the conjugate gradients that bodies have in the place of the particles' arrays.
    struct BodyVectors {
        std::vector<double> q, residual, scaled, direction;
    };
    const Array<double>& moved(const Bodies& bodies);
    solve::SolveReport step_explicitly(const ViscousContext& parts);
    solve::SolveReport solve_implicitly(const ViscousContext& parts, const Bodies& bodies);
    solve::SolveReport solve_by_rates(const ViscousContext& parts, const Bodies& bodies);
    solve::SolveReport solve_once(Progress progress);
    double find_residual(Progress& progress, bool nearly);
    void set_up(Progress& progress);
    bool start_from_last_change(Progress& progress, double square);
    void store_increment(const LiquidParticles& liquid);
    void iterate(Progress& progress);
    void iterate_cg(Progress& progress, bool nearly);
    void solve_assembled(Progress& progress);
    bool multiplies_nearly(const ViscosityOptions& options) const;
    void multiply(const ViscousContext& parts, int u_field, ViscousOperator::Walls walls, bool nearly);
    void multiply_velocities(const ViscousContext& parts, bool nearly);
    double multiply_directions(const ViscousContext& parts, bool nearly, std::vector<double>& body_product);
    double precondition(const LiquidParticles& liquid, const Array3& r, const Array3& z);
    double precondition(const LiquidParticles& liquid);
    std::vector<double> pull(const ViscousContext& parts);

    NearPairs near_;
    ViscousOperator operator_;
    std::optional<ViscousMultilevel> multilevel_; // empty: the diagonal blocks alone precondition
    std::optional<ViscousMatrix> matrix_;         // empty: products without a matrix
    ViscousBodies body_unknowns_;
    BodyVectors body_;
    Array<double> friction_;
    Array<flow::ViscosityModel> rheology_{"treacle::viscosity_models", 0};
    double dt_ = 0;
    bool last_product_is_of_u_ = false;
    int direction_ = -1;   // field
    int last_change_ = -1; // field, where the guess is made of it [m/s]
    Array3 residual_{"treacle::viscous_residual", 0}, before_{"treacle::velocity_before", 0};
    Array3 product_{"treacle::viscous_product", 0}; // C p, then z
};

} // namespace treacle::sph
