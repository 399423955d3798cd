#pragma once
#include "scene/camera/camera_model.hpp"
#include "video/camera/board.hpp"

#include <vector>

namespace treacle::video {

// Offset of the middle of a circle's image from the image of the circle's middle [pixels]: the nearer half is seen
// larger (Heikkila 2000). `centres` [m] on the plane z = 0 of the board, of which the camera has the pose; through the
// lens.
std::vector<scene::Vec2> circle_bias(
    const scene::CameraModel& camera, const std::vector<Vec3>& centres, double diameter);

// A view's points moved from the middles of the circles' images to the images of their middles, with the pose that they have
// then; those of a chessboard stay.
std::vector<scene::Vec2> unbiased_points(const scene::Lens& lens, const Board& board, const BoardView& view);

} // namespace treacle::video
