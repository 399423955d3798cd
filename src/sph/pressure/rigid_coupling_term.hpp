#pragma once
#include "mpi/comm.hpp"
#include "sph/model/step_context.hpp"
#include "sph/solids/bodies.hpp"

#include <functional>

namespace treacle::sph {

class PressureSystem;

// (S7b) Term of dynamic bodies in the pressure system, since they accelerate while the liquid presses on them: in the
// row of particle i the sum over bodies U_i M^-1 sum_j U_j^T p_j, symmetric and positive semidefinite, of rank six per
// body, never assembled. M^-1 is that of the bodies with their joints, which may link several (rigid::ConstrainedInverseMass). U_i =
// sqrt(m) / rho_i rho0 sum_s V_s (grad W, arm x grad W).
class RigidCouplingTerm {
public:
    // The rows U_i of this rank's particles, for the poses of the bodies.
    void build(const StepContext& parts, const Bodies& bodies);

    // Collective: writes to the field `response` what the term is with the pressures of the field `pressure`.
    void apply_to_pressure(const Comm& comm, LiquidParticles& liquid) const;

    // Collective: response = term x, both [owned], x as pressures [Pa].
    void apply(const Comm& comm, int owned, const Array<double>& x, const Array<double>& response) const;

    // y += term x on the rows of the system; collective. Valid until the next build().
    using Addition = std::function<void(std::span<const double> x, std::span<double> y)>;
    Addition addition(const Comm& comm, const LiquidParticles& liquid, const PressureSystem& system) const;

    // Parts of the above; not private, since nvcc takes no kernel in a private function.
    void count(const LiquidParticles& liquid, const SolidParticles& solid, const Neighbourhood& neighbours);

private:
    std::vector<double> respond(std::span<const double> impulses) const;

    rigid::ConstrainedInverseMass mobility_;
    std::size_t first_ = 0, loads_ = 0;                // number of the first body, of all loads
    Array<int> dynamic_{"treacle::dynamic", 0};        // per load: 0 or 1
    Array<int> offset_{"treacle::response_offset", 0}; // [owned + 1]
    Array<int> body_{"treacle::response_body", 0};     // [entries], number of the load
    Array<double> row_{"treacle::response_row", 0};    // [entries][6]
    int entries_ = 0;
};

} // namespace treacle::sph
