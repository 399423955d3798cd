#pragma once
#include "identify/compare/comparison.hpp"
#include "identify/compare/residual_file.hpp"
#include "identify/compare/turning.hpp"

#include <span>

namespace treacle::identify {

// Pixels of the frames of a window of time, summed. Numbers are whole: sums do not depend on how ranks share the frames.
class OccupancySum {
public:
    OccupancySum(int width, int height);

    // A frame; it does not count where `film`, its mask in the film, is excluded. `depth` [m] may be empty.
    void add(const video::Mask& film, const video::Mask& liquid, const video::FilmDepth& depth = {});
    std::span<std::int64_t> numbers() {
        return numbers_;
    } // [pixels][3] frames that count, frames with liquid, depths [um]

    // Pixels that are liquid in at least this fraction of the frames. Excluded are those that count in fewer than half of as many frames as
    // the pixel that counts most.
    video::Mask level(double fraction) const;
    video::FilmDepth depth() const; // mean of a pixel's liquid [m], 1e30 where there is none

private:
    int width_, height_;
    std::vector<std::int64_t> numbers_;
};

// A window of a film and a run.
struct OccupancyWindow {
    OccupancyWindow(int width, int height) : film(width, height), now(width, height), later(width, height) {}

    ObservedFrame frame;     // number of the mask in its middle; mean time
    double step = 0;         // [s] from now to later
    OccupancySum film;       // of the masks
    OccupancySum now, later; // of the run, and of what it shows a little later
};

// Displacements [px] of the contours at all levels; all have the window's number and time.
FrameComparison compare_window(
    const OccupancyWindow& window, const std::vector<double>& levels, const scene::CameraModel& camera);

// Noise of a displacement [px], of a film and a run that scatter as the film does from window to window: by how far contours lie, robustly,
// from the middle between those of the windows before and after, which is free of a steady growth. At least that usual of a contour.
double occupancy_noise(const std::vector<OccupancyWindow>& windows, const std::vector<double>& levels);

// Puts displacements and their derivatives into units of the noise [px].
void scale_by_noise(FrameComparison& comparison, double noise);

// Adds the rate of turning in a window, of the run less that of the film, in units of its noise: turns of both scatter as the film's do
// (relative, of a turn). It counts as much as the contours of a level do. Nothing where the film has less than half a turn.
void add_turning(FrameComparison& comparison, const ObservedFrame& frame, const TurningRate& film,
    const TurningRate& run, double scatter, std::size_t levels);

} // namespace treacle::identify
