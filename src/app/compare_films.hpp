#pragma once
#include "app/input.hpp"
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

// Priors of the films' views. Throws InputError.
identify::Priors experiment_priors(const identify::StudyFile& file);

// Compares a finished run of a scene with the films of that scene, and writes residuals_NAME.csv, mismatches_NAME.csv and
// the masks that the camera would see, masks_NAME/, into the folder. Collective; each rank draws some of the frames.
void compare_with_films(const Comm& comm, const identify::StudyFile& file, const study::StudyScene& scene, const std::filesystem::path& folder);

// Needs of a scene's films of its run: the interval of its frames, and the hash of the films' masks and
// cameras, on which its comparison depends. Throws InputError for a film that is longer than the run, masks of another size
// than the camera's pictures, and a camera that does not see the liquid's domain.
struct FilmNeeds {
    std::vector<study::Assignment> assignments;
    std::string content;
};
FilmNeeds film_needs(const identify::StudyFile& file, const study::StudyScene& scene);

} // namespace treacle::app
