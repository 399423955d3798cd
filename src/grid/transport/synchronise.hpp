#pragma once
#include "base/liquid_totals.hpp"
#include "grid/mac/mac_grid.hpp"
#include "grid/mac/particles.hpp"

#include <array>
#include <span>
#include <vector>

namespace treacle::grid {

// The lengths of a step [s].
struct StepTimes {
    double kick = 0;    // from the middle of the step before to that of this one
    double drift = 0;   // of the step
    bool first = false; // there was none before
};

// (E) Velocities at the ends of steps, for what is shown and measured; the method itself has those of the middles alone. They
// are u + drift/2 (2 a - a_before), the acceleration a = (u - u_before)/kick carried on to the end of the step as it has
// changed since the step before. Where it jumps, as in an impact, there is no velocity of the end, and u is shown.
// In the sense of |a - a_before|^2 < fraction (|a|^2 + |a_before|^2):
inline constexpr double smooth_fraction = 0.1;

// Sets end_velocity() and acceleration() of the owned particles, whose velocity() is that of the middle. `change` [window]:
// what the step made of the velocities of the faces [m/s]. Before the particles move. Local.
void end_velocities(const MacGrid& grid, const CellBox& window, const FaceField& change, const StepTimes& times,
    const GridParticles& particles);
// As at rest, of the owned particles from `begin` on: end_velocity() is velocity().
void begin_velocities(const GridParticles& particles, int begin);

// Momentum and angular momentum of all of the liquid, and velocities of dynamic bodies, at the end of a step.
// Their jump is computed for liquid and bodies together, so that their momenta of the end add up to what those of the
// middle do.
class EndMotion {
public:
    // State of the middle of the last step, after it.
    struct Middle {
        std::array<double, 6> liquid{}; // momentum [kg m/s], angular momentum [kg m2/s]
        std::vector<double> momenta;    // of the bodies, momentum and spin's angular momentum, 6 numbers each
        std::vector<double> velocities; // velocity [m/s] and spin [rad/s], 6 numbers each
    };
    void start(Middle middle);
    void record(Middle middle, const StepTimes& times);
    const std::array<double, 6>& liquid() const { return end_; }
    const std::vector<double>& lead() const {
        return lead_;
    } // of the bodies' velocities of the end before those of the middle

    // All that changes, for as many bodies.
    std::vector<double> state() const;
    void restore(std::span<const double> state, std::size_t bodies);

private:
    Middle middle_, rate_;
    std::array<double, 6> end_{};
    std::vector<double> lead_;
};

} // namespace treacle::grid
