#pragma once
#include "identify/experiment/study_file.hpp"

namespace treacle::app {

// A line of `treacle check STUDY`: a label and what goes with it; without a label a heading or a warning.
using LabelledLine = std::pair<std::string, std::string>;

// Lines of `treacle check STUDY` on the measured values: what a standard deviation of each does to the viscosity, by the power
// that the study states or, where an identification has written its result, by its run; its fraction of the variance; and how
// well to measure it for it to add 1 %. Without a result the film, camera and resolution are taken to add 2 %.
std::vector<LabelledLine> measured_fractions(const identify::StudyFile& file, const std::filesystem::path& result);

} // namespace treacle::app
