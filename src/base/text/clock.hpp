#pragma once
#include <chrono>

namespace treacle {

using Clock = std::chrono::steady_clock; // wall-clock time that never runs backwards

// Elapsed wall-clock time [s].
inline double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

} // namespace treacle
