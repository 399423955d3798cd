#pragma once
#include "mpi/comm.hpp"
#include "sph/domain.hpp"
#include "sph/neighbourhood.hpp"

#include <array>
#include <vector>

namespace treacle::sph {

enum class LossCause : int { none = 0, outflow = 1, leak = 2, non_finite = 3 };
inline constexpr int loss_causes = 3;

struct LostParticle {
    std::int64_t id;
    double position[3]; // [m]
    double velocity[3]; // [m/s]
    LossCause cause;
};

// (S9) x += dt (u + correction), wrapped along periodic axes. `correction` is the XSPH velocity in the
// acceleration field, used when `use_correction` is Use::yes. Returns how many of this rank's particles are lost by
// that, for remove_lost to take out, and how many went through open sides, for remove_outflow.
enum class Use { no, yes };
struct Departures {
    int lost = 0, outflow = 0;
};
Departures move_particles(const DomainBox& domain, LiquidParticles& liquid, double dt, Use use_correction);

// Takes out the particles of this rank that left through an open face, went through a wall, or are no longer
// finite, and returns them with their causes. Looks at every particle on the host: losses are rare.
std::vector<LostParticle> remove_lost(const DomainBox& domain, LiquidParticles& liquid);

// What the measurements and the step control need of the owned particles, summed over the ranks.
struct LiquidTotals {
    std::int64_t particles = 0;
    double mass = 0;                       // [kg], [kg/m] in the plane
    std::array<double, 3> momentum{};      // [kg m/s]
    std::array<double, 3> angular_momentum{}; // about the origin [kg m2/s]
    double kinetic_energy = 0;             // [J]
    double potential_energy = 0;           // [J], zero at the origin
    double max_speed = 0;                  // [m/s]
};
LiquidTotals measure_totals(const Comm& comm, const LiquidParticles& liquid, const Constants& constants,
                            const std::array<double, 3>& gravity);

} // namespace treacle::sph
