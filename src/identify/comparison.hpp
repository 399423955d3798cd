#pragma once
#include "identify/observation.hpp"
#include "scene/camera_model.hpp"
#include "video/film_raster.hpp"

namespace treacle::identify {

// Parameters of the view: they need no run. In this order in every list of derivatives.
enum ViewParameter { view_time, view_contour, view_focal, view_turn, view_place = view_turn + 3, view_count = view_place + 3 };
inline constexpr std::array<const char*, view_count> view_names{"time zero [s]", "contour [px]", "focal length [1]", "turn x [rad]", "turn y [rad]",
                                                               "turn z [rad]",  "place x [m]",  "place y [m]",      "place z [m]"};
using ViewDerivatives = std::array<double, view_count>;

// A segment of an observed contour against the simulated one.
struct SegmentResidual {
    int frame = 0;         // number of the mask
    double time = 0;       // [s] of the scene
    double x = 0, y = 0;   // [px] its middle
    double normal_x = 0, normal_y = 0; // outward
    double points = 0;     // number of its contour's points
    double displacement = 0; // [px] of the simulated contour from the observed one, outward
    ViewDerivatives by_view{}; // of the displacement
};

struct FrameComparison {
    std::vector<SegmentResidual> segments;
    std::int64_t mismatches = 0; // pixels that are liquid in one of the masks
    std::int64_t observed = 0, simulated = 0; // pixels of liquid
    std::int64_t compared = 0;   // pixels that are not excluded
};

// The liquid of a run as the experiment's camera sees it at the time of a mask, and a little later.
struct SimulatedFrame {
    video::FilmDrawing now, later;
    double step = 0; // [s] from now to later
};

// Compares the contours. Derivatives by the camera's parameters are those of the contour's points in space, of which the
// drawing has the depths.
FrameComparison compare_frame(const ObservedFrame& observed, const video::Mask& mask, const SimulatedFrame& simulated, const scene::CameraModel& camera);

// Half of the share of mismatches, the objective (6.9) of the dissertation for a frame with C = 1 where not excluded.
double mismatch_objective(const FrameComparison& comparison);

} // namespace treacle::identify
