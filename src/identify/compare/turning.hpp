#pragma once
#include "video/mask/mask.hpp"

#include <vector>

namespace treacle::identify {

// Column [px] of a thread's middle, from the side, a little above the heap that it falls on; not a number where there is none.
// The picture is upright; the heap begins where a row is much wider than the thread near the top.
double thread_column(const video::Mask& mask);

// Turning of a thread: times [s] at which it passes its middle, twice a turn.
struct Turning {
    std::vector<double> passages; // [s] ascending
    double scatter = 0;           // relative, of the times of whole turns; 0 where there are fewer than two
};
// positions: at these times, in any unit; those that are no number are left out. Noise about the middle is no passage.
Turning turning_of(const std::vector<double>& times, const std::vector<double>& positions);

// Frequency of a thread's turns within a window.
struct TurningRate {
    double rate = 0;  // [Hz]
    double turns = 0; // that are known
};
// Rate over the part of a window that lies between passages, evenly within a half turn; 0 where that is less than half
// of the window.
TurningRate rate_between(const Turning& turning, double begin, double end);

} // namespace treacle::identify
