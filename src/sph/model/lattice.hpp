#pragma once
#include "sph/model/options.hpp"

namespace treacle::sph {

// Sums over the full cubic (square) lattice of spacing d: the rest state that masses, volumes and densities
// refer to. A particle of the lattice, not the one in the scene, sets them, so that particles at a surface or
// in a corner weigh no more than others.
struct Lattice {
    double kernel_sum = 0;     // sum W, self included [1/m^D]
    double volume = 0;         // V0 = 1 / kernel_sum [m^D]
    double number_density = 0; // n0 = sum w, without self
    int neighbours = 0;
    double gradient_factor = 0;    // SPH gradient of p = x over 1 (cG)
    double laplacian_factor = 0;   // SPH Laplacian of p = x^2 over 2 (cL)
    double laplacian_diagonal = 0; // sum_j a_ij [1/m^2]
};
Lattice compute_lattice_sums(KernelKind kind, int dimensions, double support, double spacing);

// One layer of wall particles of spacing `wall_spacing` facing a half space of lattice liquid.
struct PlanarWall {
    double wall_volume = 0;     // V_s = 1 / sum_s W [m^D]
    double density_ratio = 0;   // rho / rho0 of the first layer (Eq. 2.1)
    double number_ratio = 0;    // n / n0 (Eq. 2.2)
    double wall_term = 0;       // |sum_s V_s grad W|^2 (alpha at rho = rho0) [1/m^2]
    double wall_vector = 0;     // |sum_s V_s grad W| [1/m]
    double liquid_vector = 0;   // |sum_j V0 grad W|, of the liquid on the other side [1/m]
    double wall_neighbours = 0; // M
    double solid_ratio = 0;     // the wall's share of density_ratio
    double laplacian = 0;       // sum_s a_is [1/m^2]
    double missing = 0;         // what sum_j a_ij lacks of the full lattice's [1/m^2]
};
struct WallSetup {
    KernelKind kind;
    int dimensions;
    double support;      // [m]
    double spacing;      // [m]
    double wall_spacing; // [m]
};
// Mean over three lateral offsets of the two lattices: none, half a spacing along one and along both directions.
PlanarWall compute_wall_sums(const WallSetup& setup, double gap);

// The distance from a wall layer at which the first layer of a resting lattice has its rest density [m].
double equilibrium_wall_distance(const WallSetup& setup, const DensityOptions& density);

// Factor on the a_is of such a wall so that the first layer at that distance lacks no neighbours: one layer of solid
// particles stands for all that lies behind it.
double wall_laplacian_factor(const WallSetup& setup, const DensityOptions& density);

// Factor on the one-sided pressure of such a wall so that the first layer at that distance is in balance when all
// pressures are equal.
double wall_pressure_factor(const WallSetup& setup, const DensityOptions& density);

// Factor on the V_s of such a wall in the viscous sums so that the first layer at that distance is in balance when the
// stress is uniform and the wall at rest (src/sph/theory.md, Implicit viscosity). These have a support of their
// own [m].
double wall_viscous_factor(const WallSetup& setup, const DensityOptions& density, double viscous_support);

} // namespace treacle::sph
