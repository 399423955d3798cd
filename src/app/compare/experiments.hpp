#pragma once
#include "app/compare/compare_films.hpp"
#include "app/compare/observation_needs.hpp"
#include "app/input/input.hpp"
#include "identify/answer/identification.hpp"
#include "mpi/comm.hpp"

#include <list>

namespace treacle::app {

// Priors of the views of all experiments. Throws InputError.
identify::Priors experiment_priors(const identify::StudyFile& file);

// Experiments of a scene of the study, in their order.
std::vector<const identify::Experiment*> experiments_of(
    const identify::StudyFile& file, const study::StudyScene& scene);

// Compares a finished run of a scene with the experiments of that scene, and writes their residuals into the folder. Collective.
// begun: comparisons that began while it was under way; null: none.
void compare_with_experiments(const Comm& comm, const identify::StudyFile& file, const study::StudyScene& scene,
    const std::filesystem::path& folder, std::list<FilmComparison>* begun = nullptr);

// Needs of a scene's experiments of its run together; their content as a hash. Throws InputError for observations that do not
// fit the scene.
ObservationNeeds scene_needs(const identify::StudyFile& file, const study::StudyScene& scene);

// Summary of an experiment's observations, for people: "24 masks", "20 fields, 11 520 vectors, 570 outliers dropped".
std::string describe_observations(const identify::StudyFile& file, const identify::Experiment& experiment);

} // namespace treacle::app
