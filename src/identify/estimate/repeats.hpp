#pragma once
#include "identify/estimate/estimate.hpp"

#include <optional>

namespace treacle::identify {

// Number of the set-up of each experiment: clips that repeat one share its.
std::vector<std::size_t> set_ups(const std::vector<Experiment>& experiments);

// Several clips of one set-up, each with an answer of its own.
struct ClipScatter {
    Eigen::VectorXd mean; // [p] of the answers of all clips
    Eigen::VectorXd
        shift; // [p] from the answer of all clips fitted together, which leans on those that fit best, to it
    Eigen::VectorXd variance; // [p] of the mean, by what clips differ beyond their own noise and time zero
    double freedom = 0;       // degrees: clips less set-ups, of those with several clips
};

// The random-effects mean (DerSimonian & Laird 1986, unweighted moments): clips weigh 1 / (own variance + variance between clips). Set-ups of one
// clip are taken to scatter as the others do. Nothing where no set-up has several clips, where several parameters are found from several
// set-ups, or where a clip alone does not determine the parameters. `set_up`: of each experiment.
std::optional<ClipScatter> between_clips(const std::vector<EvaluatedRun>& runs,
    const std::vector<ViewInformation>& priors, const std::vector<std::size_t>& set_up);

} // namespace treacle::identify
