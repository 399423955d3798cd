#pragma once
#include "app/render/scene_surface.hpp"
#include "identify/compare/comparison.hpp"
#include "identify/experiment/study_file.hpp"
#include "video/film/film_raster.hpp"

#include <string>
#include <vector>

namespace treacle::app {

// Draws the picture of a run in an experiment's camera at the times of the film's masks; each rank by itself.
class FilmDrawer {
public:
    // Throws InputError. The run must stay.
    FilmDrawer(const identify::StudyFile& file, const identify::Experiment& experiment, const RunView& run);

    // Masks that are compared, in the order of time.
    const std::vector<identify::ObservedFrame>& frames() const { return frames_; }
    const scene::CameraModel& camera() const { return model_; } // with the lens and pose of the experiment

    // Liquid at the time of a mask and a little later; frame: index in frames(), < its size.
    identify::SimulatedFrame draw(std::size_t frame);
    // Mirror image of that liquid across the plane of the experiment's occupancy; solids stay as they are.
    identify::SimulatedFrame draw_mirrored(std::size_t frame);

private:
    const RunView& run_;
    SceneSurface surface_;
    scene::CameraModel model_;
    std::vector<identify::ObservedFrame> frames_;
    video::FilmScenery scenery_;
    std::vector<std::string> through_;
    identify::Occupancy occupancy_;
    double step_ = 0, readout_ = 0;       // [s]
    const surface::Mesh* mesh_ = nullptr; // of the frame that was drawn last
    std::size_t built_ = 0;

    identify::SimulatedFrame draw(const surface::Mesh& mesh, const identify::ObservedFrame& frame) const;
    const surface::Mesh& mesh_of(std::size_t frame); // built once where it is drawn again
};

} // namespace treacle::app
