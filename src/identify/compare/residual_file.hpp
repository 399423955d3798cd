#pragma once
#include "identify/compare/comparison.hpp"

#include <filesystem>

namespace treacle::identify {

// Mean square of the differences of a measured field or value [m2/s2], or of a row of a series in units of its noise.
struct FrameSquares {
    int number = 0;
    double time = 0;   // [s] of the scene
    double square = 0; // mean over what is compared
    double count = 0;  // vectors that are compared
};

// Residuals of a run from the observations of one experiment.
struct RunResiduals {
    ExperimentKind kind = ExperimentKind::contours;
    std::vector<SegmentResidual> segments; // by frame
    std::vector<FrameComparison> frames;   // of masks, without their segments; of occupancy a window, all its levels
    std::vector<ObservedFrame> observed;   // of those frames
    std::vector<FrameSquares> squares;     // of the other kinds
    double mismatch = 0; // mean of (6.9) over the frames; (E.1) [m2/s2] of PIV; mean square of a series
};

// residuals_NAME.csv: a row a segment; mismatches_NAME.csv: a row a frame. Throws SimulationError.
void write_residuals(const std::filesystem::path& folder, const std::string& experiment, const RunResiduals& residuals);
// Throws InputError.
RunResiduals read_residuals(
    const std::filesystem::path& folder, const std::string& experiment, ExperimentKind kind = ExperimentKind::contours);

} // namespace treacle::identify
