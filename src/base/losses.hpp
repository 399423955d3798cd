#pragma once
#include <cstdint>

namespace treacle {

// Why a particle is no longer there.
// outflow: taken out by an outlet or a side that lets liquid go, no loss; open_side: left through another open side.
enum class LossCause : int { none = 0, outflow = 1, leak = 2, non_finite = 3, open_side = 4 };
inline constexpr int loss_causes = 4;

// Row of lost_particles.csv: the state at the time of removal.
struct LostParticle {
    std::int64_t id;    // unique over the run
    double position[3]; // [m]
    double velocity[3]; // [m/s]
    LossCause cause;    // never none
};

} // namespace treacle
