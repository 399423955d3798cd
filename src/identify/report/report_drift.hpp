#pragma once
#include "identify/answer/identification.hpp"

#include <string>
#include <vector>

namespace treacle::identify {

// A sentence for each experiment whose frames have another best value the later they are, by more than noise and
// resolution explain: by how much, and what does so. Empty where the model holds from the first frame to the last.
std::vector<std::string> drift_lines(const StudyFile& file, const Identification& identification);

// The best value by window of time, a table for each experiment; for the report.
std::string drift_html(const StudyFile& file, const Identification& identification);

// Values of the windows, and of a line through them, for programs.
std::string drift_yaml(const StudyFile& file, const Identification& identification);

} // namespace treacle::identify
