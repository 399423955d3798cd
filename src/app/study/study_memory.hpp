#pragma once
#include "study/study_runs.hpp"

namespace treacle::app {

// Memory that a run of a scene with these values needs, all ranks together, as `treacle check` estimates it for the scene,
// with the program itself on every rank [bytes].
double run_memory(const study::Study& study, const study::StudyScene& scene, const study::Point& values);

// The largest of several runs of a study, spread over its candidates [bytes].
double largest_run_memory(const study::Study& study, const std::vector<study::Candidate>& candidates);

// Memory that new processes may take, of the machine and of the control group [bytes].
double available_memory();

// Throws InputError when the runs of all lanes do not fit at once. Runs behind a launcher have the memory that it
// requests for them, and are not checked.
void check_memory(const study::Study& study, const std::vector<study::Candidate>& candidates);

} // namespace treacle::app
