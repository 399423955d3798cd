#include "app/compare/film_drawer.hpp"

#include "app/compare/compare_films.hpp"
#include "app/render/scenery.hpp"

#include <algorithm>

namespace treacle::app {

namespace {
surface::Mesh mirrored(surface::Mesh mesh, std::size_t axis, double at) {
    for (std::size_t i = axis; i < mesh.vertices.size(); i += 3) {
        mesh.vertices[i] = 2 * at - mesh.vertices[i];
        mesh.normals[i] = -mesh.normals[i];
        mesh.velocity[i] = -mesh.velocity[i];
    }
    for (auto& one : mesh.triangles) std::swap(one[0], one[1]); // outside stays outside
    return mesh;
}
} // namespace

FilmDrawer::FilmDrawer(const identify::StudyFile& file, const identify::Experiment& experiment, const RunView& run)
    : run_(run), surface_(Comm::self(), run, {.options = surface_options(run.input), .images = true}),
      model_(experiment_camera(file, experiment, run.input).model),
      frames_(identify::observed_frames(experiment, file.beside(experiment.masks))), through_(experiment.see_through),
      occupancy_(experiment.occupancy),
      step_(0.25 * std::max(least_interval(frames_, &identify::ObservedFrame::time), 1e-3)),
      readout_(experiment.readout) {}

const surface::Mesh& FilmDrawer::mesh_of(std::size_t frame) {
    if (mesh_ && built_ == frame) return *mesh_;
    mesh_ = &surface_.build(nearest_frame(run_, frames_[frame].time));
    built_ = frame;
    if (scenery_.depth.empty() || surface_.solids_move())
        scenery_ = draw_scenery(run_.input, surface_.solids(), model_, through_);
    return *mesh_;
}

identify::SimulatedFrame FilmDrawer::draw(std::size_t frame) { return draw(mesh_of(frame), frames_[frame]); }

identify::SimulatedFrame FilmDrawer::draw_mirrored(std::size_t frame) {
    const auto axis = std::size_t(occupancy_.mirror) - std::size_t(identify::MirrorAxis::x);
    return draw(mirrored(mesh_of(frame), axis, occupancy_.mirror_at), frames_[frame]);
}

identify::SimulatedFrame FilmDrawer::draw(const surface::Mesh& mesh, const identify::ObservedFrame& frame) const {
    video::FilmShot shot;
    shot.samples = 1;
    shot.offset = frame.time - surface_.time();
    shot.readout = readout_;
    const video::FilmMesh drawn{mesh.dimensions, mesh.vertices, mesh.normals, mesh.velocity, mesh.triangles};
    identify::SimulatedFrame out;
    out.step = step_;
    out.now = video::draw_liquid(drawn, model_, shot, scenery_.depth);
    shot.offset += step_;
    out.later = video::draw_liquid(drawn, model_, shot, scenery_.depth);
    return out;
}

} // namespace treacle::app
