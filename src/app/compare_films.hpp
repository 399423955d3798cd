#pragma once
#include "app/frame_set.hpp"
#include "app/observation_needs.hpp"
#include "identify/identification.hpp"
#include "mpi/comm.hpp"

namespace treacle::app {

// The camera of an experiment with what is known of its uncertainty.
struct ExperimentCamera {
    scene::CameraModel model;
    std::optional<Eigen::Matrix<double, 6, 6>> pose_covariance;
    double focal_deviation = 0; // relative; 0: not known
};
// Throws InputError for a camera that is neither a file beside the study nor one of the scene's.
ExperimentCamera experiment_camera(const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input);

// Compares a finished run with the masks of a film, and writes residuals_NAME.csv, mismatches_NAME.csv and the masks that the
// camera would see, masks_NAME/, into the folder. Collective; each rank draws some of the frames.
void compare_with_film(const Comm& comm, const identify::StudyFile& file, const identify::Experiment& experiment, const RunView& run,
                       const std::filesystem::path& folder);

// Needs of a film of its run: frames at the times of the masks. Throws InputError for a film that is longer than the run, and
// masks of another size than the camera's pictures.
ObservationNeeds film_needs(const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input);

} // namespace treacle::app
