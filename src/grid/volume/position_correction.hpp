#pragma once
#include "grid/geometry/mirror_particles.hpp"
#include "grid/mac/particles.hpp"
#include "grid/transport/advection.hpp"
#include "kokkos/neighbour_list.hpp"
#include "mpi/halo.hpp"

namespace treacle::grid {

// Keeping particles evenly spread, as advection alone does not (dissertation 5.3.5).
enum class PositionMethod {
    none,
    density, // density constraints C = max(rho / rho_0 - 1, 0), with those of the neighbours (Macklin and Mueller 2013)
    distance, // springs between close particles (Ando and Tsuruno 2011); to compare with
};

// Options of the block `correction`.
struct PositionOptions {
    PositionMethod method = PositionMethod::density;
    int iterations = 6;     // at most
    double tolerance = 0.1; // of the largest C
    // Constraints push by what is above it: nothing draws particles together again, so that pushing away noise below the
    // tolerance, step after step, would swell the liquid (a sloshing tank by 11 % in 6 s, with this by 7 %).
    double dead_band = 0.05;
    double relaxation = 1;             // of each iteration's correction; 1 to 5 where only own constraints count
    bool neighbour_constraints = true; // sum over lambda_i + lambda_j; else each its own alone
    double cfm_epsilon = 1e-2;         // CFM, over the sum of squared gradients inside of a lattice
    double scale_min = 1,
           scale_max = 1; // distance scaling alpha = clamp(phi / dx, min, max); 1 to 5 in the dissertation
    double cap = 0.1;     // largest move of a particle in all iterations, over dx
};

// Result of one correction, over all ranks.
struct PositionReport {
    int iterations = 0;
    double density_before = 0, density_after = 0; // largest rho / rho_0 - 1
    double largest_move = 0;                      // [m]
    double energy = 0;                            // potential energy that it added [J]
};

// Corrector of particle positions; keeps the kernel's sums over a lattice at rest.
class PositionCorrection {
public:
    explicit PositionCorrection(const MacGrid& grid);

    // Collective. Moves the owned particles and their ghosts; sort, halo and cell list must be of the positions before,
    // with the ghosts' liquid gathered. Particles near solids have the images of those beside them as neighbours: walls
    // neither draw nor push. Writes the field `density`. `particle_mass` [liquids] [kg]; `gravity` [m/s2] for the
    // energy.
    struct Setting {
        const CellList& cells;
        Halo& halo;
        const Comm& comm;
        const Solids& solids;
        Array<double> particle_mass; // [liquids] [kg]
        double gravity[3];           // [m/s2]
    };
    PositionReport apply(const PositionOptions& options, GridParticles& particles, const Setting& setting);

private:
    double correct(const PositionOptions& options, GridParticles& particles, const Setting& setting);

    MacGrid grid_;
    double rest_ = 0;           // sum of the kernel over the lattice of two particles per axis and cell
    double rest_gradients_ = 0; // of the squared gradients of a particle's constraint there [1/m2]
    NeighbourList neighbours_;
    Array3 start_{"treacle::start", 0};
    Array4 packed_{"treacle::correction_packed", 0};
    Array<int> near_{"treacle::near_solids", 0};
};

} // namespace treacle::grid
