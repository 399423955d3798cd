#pragma once
#include "app/input/input.hpp"
#include "scene/camera/camera_model.hpp"
#include "surface/field/solids.hpp"
#include "video/film/film_raster.hpp"

namespace treacle::app {

// Throws InputError at `where` for a name that no body of the scene has.
void require_bodies(const Input& input, const std::vector<std::string>& names, const std::string& where);

// The bodies that a camera shows, at the poses of `solids`; hollow ones show what is in them, and those of the names in
// `through` are clear. Nothing in a 2D scene.
video::FilmScenery draw_scenery(const Input& input, const surface::Solids& solids, const scene::CameraModel& camera,
    const std::vector<std::string>& through = {});

} // namespace treacle::app
