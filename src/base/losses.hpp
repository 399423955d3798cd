#pragma once
#include <cstdint>

namespace treacle {

// Why a particle is no longer there.
enum class LossCause : int { none = 0, outflow = 1, leak = 2, non_finite = 3 };
inline constexpr int loss_causes = 3;

struct LostParticle {
    std::int64_t id;
    double position[3]; // [m]
    double velocity[3]; // [m/s]
    LossCause cause;
};

} // namespace treacle
