#pragma once
#include "identify/comparison.hpp"

#include <filesystem>

namespace treacle::identify {

// What a run's contours are away from those of one experiment.
struct RunResiduals {
    std::vector<SegmentResidual> segments; // by frame
    std::vector<FrameComparison> frames;   // without their segments
    std::vector<ObservedFrame> observed;   // of the frames
    double mismatch = 0;                   // mean of (6.9) over the frames
};

// residuals_NAME.csv: a row a segment; mismatches_NAME.csv: a row a frame. Throws SimulationError.
void write_residuals(const std::filesystem::path& folder, const std::string& experiment, const RunResiduals& residuals);
// Throws InputError.
RunResiduals read_residuals(const std::filesystem::path& folder, const std::string& experiment);

} // namespace treacle::identify
