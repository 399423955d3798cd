#pragma once
#include "identify/report/report_pictures.hpp"

namespace treacle::identify {

// Arrows of up to four fields of an experiment with PIV: measured, simulated, and the difference five times as long, side by
// side. NAME_000012.svg in `folder`; returns their names with a caption each. `run` holds fields_NAME.csv. Throws SimulationError.
std::vector<ReportPicture> write_field_pictures(
    const std::filesystem::path& folder, const Experiment& experiment, const std::filesystem::path& run);

} // namespace treacle::identify
