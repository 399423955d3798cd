#pragma once
#include "base/liquid_totals.hpp"
#include "base/losses.hpp"
#include "mpi/comm.hpp"
#include "sph/model/domain.hpp"
#include "sph/model/neighbourhood.hpp"

#include <array>
#include <vector>

namespace treacle::sph {

using treacle::LiquidTotals;
using treacle::loss_causes;
using treacle::LossCause;
using treacle::LostParticle;

// (S9) x += dt (u + correction), wrapped along periodic axes. `correction` is the XSPH velocity in the
// acceleration field, used when `use_correction` is Use::yes. Returns how many of this rank's particles are lost by
// that, for remove_lost to take out, and how many went through sides that let them go, for remove_outflow.
enum class Use { no, yes };
struct DepartureCounts {
    int lost = 0, outflow = 0;
};
DepartureCounts move_particles(const DomainBox& domain, LiquidParticles& liquid, double dt, Use use_correction);

// Takes out the particles of this rank that left through an open side, went through a wall, or are no longer
// finite, and returns them with their causes. Checks every particle on the host: losses are rare.
std::vector<LostParticle> remove_lost(const DomainBox& domain, LiquidParticles& liquid);

// Totals of the owned particles, summed over the ranks, with these of their velocities [m/s].
LiquidTotals measure_totals(const Comm& comm, const LiquidParticles& liquid, const Constants& constants,
    const std::array<double, 3>& gravity, const Array3& velocity);
// Momentum [kg m/s] and angular momentum about the origin [kg m2/s] with these velocities, summed over the ranks; with
// accelerations their rates.
std::array<double, 6> measure_momentum(
    const Comm& comm, const LiquidParticles& liquid, const Constants& constants, const Array3& velocity);

} // namespace treacle::sph
