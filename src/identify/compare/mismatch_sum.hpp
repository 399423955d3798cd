#pragma once
#include <limits>
#include <optional>
#include <vector>

namespace treacle::identify {

// (6.9) of the masks of a film that a run has been compared with so far.
struct FilmMismatches {
    std::size_t masks = 0;          // that are compared in all
    std::vector<double> times;      // [s] of those compared so far, in order
    std::vector<double> mismatches; // of each
    double next =
        std::numeric_limits<double>::infinity(); // [s] of the first that is not compared yet; infinite: all are
};

// The sum over films of their mean (6.9) only grows from frame to frame: what it is, or has reached, after the first
// frame at which it is above the cut, in the order of time and films; nothing where it is not above it. The same at any
// time once that frame is compared: frames behind one that is missing do not count.
std::optional<double> mismatch_bound(const std::vector<FilmMismatches>& films, double cut);

} // namespace treacle::identify
