#pragma once
#include "grid/mac/mac_grid.hpp"
#include "grid/mac/particles.hpp"
#include "grid/pressure/pressure_coupling.hpp"
#include "kokkos/cells.hpp"
#include "mpi/cell_halo.hpp"

namespace treacle::grid {

// Input of a balance of momentum (M); arrays are over the window of the halo, particles with their ghosts.
struct MomentumScene {
    const MacGrid& grid;
    CellHalo& halo;
    const CellList& cells;                   // of the particles
    const Array<double>& distance;           // [window] of cells' centres from the liquid's surface [m]
    const FaceField& fluid;                  // fractions of the faces' cubes that are not solid
    const FaceBodyFractions& body_fractions; // of bodies that move
    const GridParticles& particles;
    const Array3& kept;                 // of each particle, after the last balance [kg m2/s]
    const Array<double>& particle_mass; // [liquids] [kg]
};

// Gravity, which pulls at liquid and bodies alike.
struct MomentumKick {
    const Vec3& gravity; // [m/s2]
    double time;         // that it acted for [s]
};

} // namespace treacle::grid
