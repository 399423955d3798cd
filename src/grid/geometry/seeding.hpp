#pragma once
#include "grid/mac/mac_grid.hpp"
#include "grid/mac/particles.hpp"
#include "mpi/decomposition.hpp"
#include "scene/sampling/sampling.hpp"

#include <functional>

namespace treacle::grid {

// Particles of a full cell at the start, along each axis.
inline constexpr int particles_per_axis = 2;

// Velocity of a liquid at the start: u_i(x) = at_origin_i + gradient_i . x.
struct LinearVelocity {
    Vec3 at_origin{0, 0, 0};        // [m/s]
    std::array<Vec3, 3> gradient{}; // [1/s] row i is that of u_i
};

// Particles of a run: 2 per axis and cell, each at random around the middle of its share of the cell. Of shares that surfaces cut as many
// hold a particle, evenly spread, as their liquid fills, so that a liquid has its volume at any spacing and offset, sheets down to
// a quarter of a cell. The layers up to a surface are spread evenly in each column along the axis that the surface is steepest along, so that it is
// smooth at any spacing (liquids made of meshes are left as they are). The random numbers are those of the cell and the share: particles and ids do
// not depend on the ranks.
struct Seeding {
    std::vector<scene::Regions> liquids;               // where two overlap, the first one wins
    std::function<double(const Vec3&)> solid_distance; // [m]
    double clearance = 0.05;                           // least distance from solids, over dx
    double jitter = 0.25;            // farthest from the middle of its share along each axis, over its width
    std::vector<double> viscosities; // [Pa s] per liquid, unless `viscosity` is given
    std::function<double(int, const Vec3&)> viscosity; // [Pa s] of liquid and place
    std::vector<LinearVelocity> velocities;            // per liquid; the affine matrices start with their gradients
};

// Volume that a particle stands for [m3], in 2D [m2] times dx.
double particle_volume(const MacGrid& grid);

// Bound of the ids of one liquid.
std::int64_t seeded_ids(const MacGrid& grid);

// Adds the particles in this rank's cells. Ids: liquid * shares of the grid + number of the share.
void seed(const Seeding& seeding, const MacGrid& grid, const Decomposition& decomposition, GridParticles& particles);

} // namespace treacle::grid
