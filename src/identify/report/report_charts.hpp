#pragma once
#include "identify/answer/identification.hpp"
#include "study/plots/chart.hpp"

#include <optional>
#include <string>

namespace treacle::identify {

// Name of the dissertation's objective of an experiment.
std::string mismatch_title(const Experiment& one);

// The search's objective, or the mismatch of an experiment, over the values of the trials.
study::Chart objective_chart(
    const StudyFile& file, const Identification& identification, std::optional<std::size_t> experiment);

// Residuals that the estimate leaves, by the time of their frames.
study::Chart misfit_chart(const StudyFile& file, const Estimate& estimate, std::size_t experiment);

// Values in the order of the trials.
study::Chart convergence_chart(const StudyFile& file, const Identification& identification);

} // namespace treacle::identify
