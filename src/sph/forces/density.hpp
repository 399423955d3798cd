#pragma once
#include "sph/model/moment_reference_points.hpp"
#include "sph/model/neighbourhood.hpp"

namespace treacle::sph {

// (S1)-(S3) Density by the smooth kernel, number density by the spiky one, and their blend near solids
// (Eqs. 2.1-2.3). Writes density and blended_density of the owned particles [kg/m3].
void compute_density(const SphOptions& options, const Constants& constants, LiquidParticles& liquid,
    const SolidParticles& solid, const Neighbourhood& neighbours);

// Constants::wall_packing. With `recovery: positions` liquid that has moved stands nearer to a wall than the lattice from which
// its place comes, and would sink by a per cent of a tank ten spacings wide (src/sph/theory.md).
double wall_packing(const PressureOptions& options, int dimensions);

// Volumes of solid particles, V_s = 1 / sum_s W over the solids themselves (Akinci et al. 2012). `list` holds
// the solid neighbours of solids; owned rows are written. Solids that rest count among each other, as where two walls
// meet; one that moves counts by itself, whatever it touches at the start.
void compute_solid_volumes(const SphOptions& options, const Constants& constants, SolidParticles& solid,
    const NeighbourList& list, const MomentReferencePoints& points = 0);

// Mean and largest compression max(0, rho / rho0 - 1) of the owned particles: the sum and the maximum.
struct Compression {
    double sum = 0; // of the owned particles [1]
    double max = 0; // of the owned particles [1]
};
Compression measure_compression(const Constants& constants, const LiquidParticles& liquid);

} // namespace treacle::sph
