#pragma once
#include <array>
#include <vector>

namespace treacle::identify {

// Quantity that an experiment observes.
enum class ExperimentKind { contours, occupancy, piv, series };
// True when it compares masks of a film.
inline bool has_masks(ExperimentKind kind) {
    return kind == ExperimentKind::contours || kind == ExperimentKind::occupancy;
}

// Parameters of the view: they need no run, and are nuisances with priors. In this order in every list of derivatives.
// Contours, those of occupancy too:
enum ViewParameter {
    view_time,
    view_contour,
    view_focal,
    view_turn,
    view_position = view_turn + 3,
    view_readout = view_position + 3,
    view_count
};
// A sheet of PIV: time zero, relative scale, shifts and turn in its plane. The first is the time of every kind.
enum SheetParameter { sheet_time, sheet_scale, sheet_right, sheet_up, sheet_turn, sheet_count };
// A series of numbers: time zero, offset and relative scale of the instrument.
enum SeriesParameter { series_time, series_offset, series_scale, series_count };

// [view_count] by ViewParameter, or by those of the experiment's kind; residual's unit per parameter's.
using ViewDerivatives = std::array<double, view_count>;

// Parts of the variance of an answer that come from the view.
enum class ViewPart { time, contour, camera, sheet, instrument };

// Name and part of one view parameter.
struct ViewParameterFacts {
    const char* name; // with its unit
    ViewPart part;    // part of the variance that its uncertainty counts for
};
// view_count at most; derivatives beyond them are 0.
const std::vector<ViewParameterFacts>& view_parameters(ExperimentKind kind);

// Standard deviation of a residual that is usual, in its unit: half a pixel of a contour; others are in units of their noise, those of occupancy too.
double usual_noise(ExperimentKind kind);

} // namespace treacle::identify
