#pragma once
#include "identify/answer/identification.hpp"

namespace treacle::identify {

// True when a body follows a measured path in the experiment: then only inertia depends on a viscosity.
bool prescribes(const Experiment& experiment);

// Throws InputError for a study whose experiments all prescribe their flow, without runs that measure the numerical scatter:
// viscosities then differ by less than resolutions do.
void check_scatter_is_measured(const StudyFile& file);

// (I4a) Widens the interval to the values of the search's trials that are not worse than the best one by more than chance: by what a
// likelihood ratio of 90 % allows, and, where all experiments prescribe their flow, by what the objective differs between runs of
// equal parameters and slightly different spacings. The interval of the local model misses them where the residuals hardly depend
// on a parameter, and their derivatives are those of the numerical noise. Values are moved as the rungs have moved the answer.
void widen_to_alike_trials(const StudyFile& file, Identification& identification);

} // namespace treacle::identify
