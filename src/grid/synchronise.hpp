#pragma once
#include "base/liquid_totals.hpp"
#include "grid/particles.hpp"
#include "grid/mac_grid.hpp"

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
// In the sense of |a - a_before|^2 < share (|a|^2 + |a_before|^2):
inline constexpr double smooth_share = 0.5;

// Sets end_velocity() and acceleration() of the owned particles, whose velocity() is that of the middle. `change` [window]:
// what the step made of the velocities of the faces [m/s]. Before the particles move. Local.
void end_velocities(const MacGrid& grid, const CellBox& window, const FaceField& change, const StepTimes& times,
                    const GridParticles& particles);
// As at rest, of the owned particles from `begin` on: end_velocity() is velocity().
void begin_velocities(const GridParticles& particles, int begin);

// The same of six sums over all of the liquid, momentum and angular momentum, which stay exact where nothing pushes.
class EndMomentum {
public:
    // Of the middle of the step, after it; at the start, with times of no length, of the start.
    void record(const std::array<double, 6>& middle, const StepTimes& times);
    const std::array<double, 6>& at_end() const { return end_; }
    std::vector<double> state() const;
    void restore(std::span<const double> state);

private:
    std::array<double, 6> middle_{}, rate_{}, end_{};
};

} // namespace treacle::grid
