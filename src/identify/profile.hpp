#pragma once
#include "identify/identification.hpp"

namespace treacle::identify {

// Widens the interval to the values of the search's trials that are not worse than the best one by more than chance: by what the
// objective differs between runs of equal parameters and slightly different spacings (the numerical noise), and by what a
// likelihood ratio of 90 % allows. The interval of the local model misses them where the residuals hardly depend on a parameter,
// and their derivatives are those of the noise.
void widen_to_alike_trials(const StudyFile& file, Identification& identification);

} // namespace treacle::identify
