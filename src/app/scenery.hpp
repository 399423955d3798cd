#pragma once
#include "app/input.hpp"
#include "scene/camera_model.hpp"
#include "surface/solids.hpp"
#include "video/film_raster.hpp"

namespace treacle::app {

// The bodies that a camera sees, where `solids` has them; hollow ones show what is in them. Nothing in a plane scene.
video::FilmScenery draw_scenery(const Input& input, const surface::Solids& solids, const scene::CameraModel& camera);

} // namespace treacle::app
