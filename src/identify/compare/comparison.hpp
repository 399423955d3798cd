#pragma once
#include "identify/experiment/observation.hpp"
#include "identify/experiment/views.hpp"
#include "scene/camera/camera_model.hpp"
#include "video/film/film_raster.hpp"

namespace treacle::identify {

// A segment of an observed contour against the simulated one; likewise a component of a measured velocity, or a value of a
// series, against the simulated one.
struct SegmentResidual {
    int frame = 0;                     // number of the mask, of that in the middle of a window, of the field, the row
    double time = 0;                   // [s] of the scene
    double x = 0, y = 0;               // its middle [px]; of the vector in the sheet [m]
    double normal_x = 0, normal_y = 0; // outward; of a velocity the direction of the component in the sheet
    double points = 0; // number of its contour's points; of others 1, and 0 where the run has nothing to compare
    double displacement =
        0; // [px] of the simulated contour from the observed one, outward; else simulated less measured in units of
           // the measurement's noise; not a number where the run has no liquid
    ViewDerivatives by_view{}; // of the displacement
};

// Difference of one mask and the run; of a window of frames: of its levels together.
struct FrameComparison {
    std::vector<SegmentResidual> segments;    // of the observed contour, in its order
    std::int64_t mismatches = 0;              // pixels that are liquid in one of the masks
    std::int64_t observed = 0, simulated = 0; // pixels of liquid
    std::int64_t compared = 0;                // pixels that are not excluded
    double beyond =
        0; // [px] how far points of the simulated contour lie from the observed one beyond ten, sum over segments' lengths
};

// The liquid of a run in the picture of the experiment's camera at the time of a mask, and a little later.
struct SimulatedFrame {
    video::FilmDrawing now, later;
    double step = 0; // [s] from now to later
};

// Compares the contours. Derivatives by the camera's parameters are those of the contour's points in 3D, of which the
// drawing has the depths.
FrameComparison compare_frame(const ObservedFrame& observed, const video::Mask& mask, const SimulatedFrame& simulated,
    const scene::CameraModel& camera);

// Half of the share of mismatches, the objective (6.9) of the dissertation for a frame with C = 1 where not excluded.
double mismatch_objective(const FrameComparison& comparison);

} // namespace treacle::identify
