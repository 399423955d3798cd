#pragma once
#include "app/compare/film_drawer.hpp"
#include "app/compare/observation_needs.hpp"
#include "identify/answer/identification.hpp"
#include "identify/compare/mismatch_sum.hpp"
#include "mpi/comm.hpp"

#include <optional>

namespace treacle::app {

// The camera of an experiment with what is known of its uncertainty.
struct ExperimentCamera {
    scene::CameraModel model;
    std::optional<Eigen::Matrix<double, 6, 6>> pose_covariance;
    double focal_deviation = 0; // relative; 0: not known
};
// Throws InputError for a camera that is neither a file beside the study nor one of the scene's.
ExperimentCamera experiment_camera(
    const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input);

// Compares a run, be it under way, with the masks of a film; the simulated masks go into masks_NAME/ in the folder.
// Collective; each rank draws some of the frames.
class FilmComparison {
public:
    // The study must stay. Throws InputError.
    FilmComparison(const Comm& comm, const identify::StudyFile& file, const identify::Experiment& experiment,
        std::filesystem::path folder);

    // Compares the masks that a run under way has reached meanwhile, one mask per rank at a time; other ranks block.
    void compare_up_to(const RunView& run);
    // All others, and then writes residuals_NAME.csv and mismatches_NAME.csv. The run has ended.
    void complete(const RunView& run);
    identify::FilmMismatches mismatches() const; // so far
    const identify::Experiment& experiment() const { return experiment_; }

private:
    void look_at(const RunView& run);
    void compare_turn();

    Comm comm_;
    const identify::StudyFile& file_;
    const identify::Experiment& experiment_;
    std::filesystem::path folder_, masks_;
    std::vector<identify::ObservedFrame> frames_;
    std::optional<FilmDrawer> film_;
    const RunView* drawn_ = nullptr; // the run that is drawn
    identify::RunResiduals residuals_;
};

// Needs of a film of its run: frames at the times of the masks. Throws InputError for a film that is longer than the run, and
// masks of another size than the camera's pictures.
ObservationNeeds film_needs(
    const identify::StudyFile& file, const identify::Experiment& experiment, const Input& input);

} // namespace treacle::app
