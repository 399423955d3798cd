#pragma once
#include <Kokkos_Core.hpp>

#include <array>
#include <span>
#include <vector>

namespace treacle::flow {

// The lengths of a step [s].
struct StepTimes {
    double kick = 0;    // from the middle of the step before to that of this one
    double drift = 0;   // of the step
    bool first = false; // there was none before
};

// Velocities at the ends of steps, for what is shown and measured; the methods themselves have those of the middles alone. They
// are u + drift/2 (2 a - a_before), the acceleration a = (u - u_before)/kick carried on to the end of the step as it has
// changed since the step before. Where it jumps, as in an impact, there is no velocity of the end, and u is shown.
// In the sense of |a - a_before|^2 < fraction (|a|^2 + |a_before|^2):
inline constexpr double smooth_fraction = 0.1;

// The rate [1/s] of a vector carried on to the end of a step: twice the rate less that of the step before, or 0 where it has jumped.
KOKKOS_INLINE_FUNCTION void carry_rate(const double rate[3], const double before[3], bool first, double out[3]) {
    double jump = 0, size = 0;
    for (int k = 0; k < 3; ++k) {
        const double from = first ? rate[k] : before[k];
        jump += (rate[k] - from) * (rate[k] - from);
        size += rate[k] * rate[k] + from * from;
        out[k] = 2 * rate[k] - from;
    }
    if (jump < smooth_fraction * size) return;
    for (int k = 0; k < 3; ++k) out[k] = 0;
}

// Momentum and angular momentum of all of the liquid, and of dynamic bodies, at the end of a step. Their jump is computed for
// liquid and bodies together, so that their momenta of the end add up to what those of the middle do.
class EndMotion {
public:
    // State of the middle of the last step, after it.
    struct Middle {
        std::array<double, 6> liquid{}; // momentum [kg m/s], angular momentum [kg m2/s]
        std::vector<double> bodies;     // of rigid::RigidBodies::free_momenta(), the three linear numbers first
    };
    static constexpr std::size_t body_numbers = 9;
    void start(Middle middle);
    // The same, with the rates [1/s] that forces known before the first step give, which is then not StepTimes::first.
    void start(Middle middle, Middle rate);
    // Known parts of the bodies' changes, as Middle::bodies. `impacts`: by impacts since the last step, which are no rate;
    // `weights`: rates by gravity alone [1/s].
    struct Known {
        std::span<const double> impacts, weights;
    };
    void record(Middle middle, const Known& known, const StepTimes& times);
    const std::array<double, 6>& liquid() const { return end_; }
    // Momenta of the bodies at the end before those of the middle, as Middle::bodies.
    const std::vector<double>& lead() const { return lead_; }

    // All that changes, for as many bodies.
    std::vector<double> state() const;
    void restore(std::span<const double> state, std::size_t bodies);

private:
    Middle middle_, rate_;
    std::array<double, 6> end_{};
    std::vector<double> lead_;
};

} // namespace treacle::flow
