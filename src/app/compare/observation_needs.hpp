#pragma once
#include "study/study_runs.hpp"

#include <algorithm>
#include <functional>

namespace treacle::app {

// Needs of an experiment of its run: the times of frames, keys of the scene that it sets, and all on which the comparison
// depends.
struct ObservationNeeds {
    std::vector<double> times; // [s] of frames
    std::vector<study::Assignment> assignments;
    std::string content;
    double step_per_spacing = 0; // [s/m] largest step of a run over its spacing; 0: none
};

// The least time between observations in their order [s]; 0 for one. `time` returns that of one.
template <class Frames, class Time>
double least_interval(const Frames& frames, Time time) {
    double least = 0;
    for (std::size_t i = 1; i < frames.size(); ++i) {
        const double gap = std::invoke(time, frames[i]) - std::invoke(time, frames[i - 1]);
        least = least > 0 ? std::min(least, gap) : gap;
    }
    return least;
}

// Throws InputError where an experiment is compared beyond the end of its scene [s].
void check_end(const std::string& where, const std::string& name, double last, double end);

} // namespace treacle::app
