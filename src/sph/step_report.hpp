#pragma once
#include "solve/krylov/krylov.hpp"
#include "sph/forces/forces.hpp"
#include "sph/forces/motion.hpp"
#include "sph/pressure/prediction.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace treacle::sph {

// Results of one step.
struct StepReport {
    double dt = 0; // [s]
    solve::SolveReport pressure;
    solve::SolveReport viscosity;   // of the implicit one
    RoleCounts roles;               // over all ranks
    std::int64_t stopped = 0;       // particles stopped at the surface of a solid, over all ranks
    std::int64_t pinned = 0;        // Poisson particles made Dirichlet for solvability
    std::int64_t misclassified = 0; // that (S6) gave another role than the exact solution, over all ranks
    double mean_compression = 0;    // of the density at the start of the step, share of rho0
    double max_compression = 0;     // the largest, over all ranks
    double imbalance = 1;           // largest over mean number of particles per rank
    BodyLoads loads;                // [body][6] by pressure, summed over ranks [N], [N m]
    BodyLoads viscous_loads;        // by viscosity, physical and artificial
    std::vector<LostParticle> lost; // of this rank, but for what flowed out
    std::array<std::int64_t, loss_causes> lost_by_cause{}; // over all ranks
};

} // namespace treacle::sph
