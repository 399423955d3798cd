#include "identify/estimate/view_priors.hpp"

#include <algorithm>

namespace treacle::identify {

namespace {
double information(double deviation) { return 1 / std::max(1e-24, deviation * deviation); }
} // namespace

ViewInformation sheet_information(const ViewUncertainty& uncertainty) {
    ViewInformation out = ViewInformation::Identity(); // of the parameters that a sheet does not have
    out(sheet_time, sheet_time) = information(uncertainty.time_zero);
    out(sheet_scale, sheet_scale) = information(uncertainty.scale);
    out(sheet_right, sheet_right) = out(sheet_up, sheet_up) = information(uncertainty.shift);
    out(sheet_turn, sheet_turn) = information(uncertainty.turn);
    return out;
}

ViewInformation series_information(const ViewUncertainty& uncertainty, const Series& series) {
    ViewInformation out = ViewInformation::Identity();
    out(series_time, series_time) = information(uncertainty.time_zero);
    out(series_offset, series_offset) = information(series.offset);
    out(series_scale, series_scale) = information(uncertainty.scale);
    return out;
}

ViewInformation information_of(const ViewUncertainty& uncertainty,
    const std::optional<Eigen::Matrix<double, 6, 6>>& pose, double focal_deviation) {
    ViewInformation out = ViewInformation::Zero();
    out(view_time, view_time) = information(uncertainty.time_zero);
    out(view_contour, view_contour) = information(uncertainty.contour);
    out(view_readout, view_readout) = information(uncertainty.readout);
    out(view_focal, view_focal) = information(focal_deviation > 0 ? focal_deviation : uncertainty.focal);
    if (pose) {
        out.block<6, 6>(view_turn, view_turn) = (*pose + 1e-24 * Eigen::Matrix<double, 6, 6>::Identity()).inverse();
    } else {
        for (int k = 0; k < 3; ++k) {
            out(view_turn + k, view_turn + k) = information(uncertainty.turn);
            out(view_position + k, view_position + k) = information(uncertainty.position);
        }
    }
    return out;
}

} // namespace treacle::identify
