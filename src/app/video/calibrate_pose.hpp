#pragma once
#include "app/video/calibrate.hpp"
#include "base/text/log.hpp"
#include "video/camera/camera_file.hpp"

namespace treacle::app {

// True for a request of a pose, an overlay or the vertical.
bool asks_for_pose(const CalibrateRequest& request);

// Finds the pose by the request's means, refines it, prints how well it is known, draws the overlay. InputError.
void find_pose(const CalibrateRequest& request, video::CameraRecord& camera, Log& log);

} // namespace treacle::app
