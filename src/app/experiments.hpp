#pragma once
#include "app/input.hpp"
#include "app/observation_needs.hpp"
#include "identify/identification.hpp"
#include "mpi/comm.hpp"

namespace treacle::app {

// Priors of the views of all experiments. Throws InputError.
identify::Priors experiment_priors(const identify::StudyFile& file);

// Compares a finished run of a scene with the experiments of that scene, and writes their residuals into the folder. Collective.
void compare_with_experiments(const Comm& comm, const identify::StudyFile& file, const study::StudyScene& scene, const std::filesystem::path& folder);

// Needs of a scene's experiments of its run together; their content as a hash. Throws InputError for observations that do not
// fit the scene.
ObservationNeeds scene_needs(const identify::StudyFile& file, const study::StudyScene& scene);

// Summary of an experiment's observations, for people: "24 masks", "20 fields, 11 520 vectors, 570 outliers dropped".
std::string describe_observations(const identify::StudyFile& file, const identify::Experiment& experiment);

} // namespace treacle::app
