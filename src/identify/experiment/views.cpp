#include "identify/experiment/views.hpp"

namespace treacle::identify {

const std::vector<ViewParameterFacts>& view_parameters(ExperimentKind kind) {
    using enum ViewPart;
    static const std::vector<ViewParameterFacts> contours{{"time zero [s]", time}, {"contour [px]", contour},
        {"focal length [1]", camera}, {"turn x [rad]", camera}, {"turn y [rad]", camera}, {"turn z [rad]", camera},
        {"place x [m]", camera}, {"place y [m]", camera}, {"place z [m]", camera}, {"readout [s]", time}};
    static const std::vector<ViewParameterFacts> sheets{{"time zero [s]", time}, {"scale [1]", sheet},
        {"shift right [m]", sheet}, {"shift up [m]", sheet}, {"turn [rad]", sheet}};
    static const std::vector<ViewParameterFacts> series{
        {"time zero [s]", time}, {"offset", instrument}, {"scale [1]", instrument}};
    return has_masks(kind) ? contours : kind == ExperimentKind::piv ? sheets : series;
}

double usual_noise(ExperimentKind kind) { return kind == ExperimentKind::contours ? 0.5 : 1; }

} // namespace treacle::identify
