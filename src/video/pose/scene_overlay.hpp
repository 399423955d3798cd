#pragma once
#include "video/camera/camera_file.hpp"
#include "video/drawing/view.hpp"
#include "video/picture/image.hpp"
#include "video/pose/solid_view.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace treacle::video {

// Colour of a solid in the overlay: liquids blue, bodies orange.
enum class OverlayKind { liquid, body };

// Objects that are drawn over a frame.
struct SceneOverlay {
    std::vector<SeenSolid> solids;  // with signed distances in the scene's axes
    std::vector<OverlayKind> kinds; // of each solid
    DomainBox domain;               // edges are drawn in 3D; the axes have 0.15 of its diagonal
    std::optional<Mask> silhouette; // its outline is drawn too
    std::string caption;            // bottom left, plain ASCII; may be empty
};

// A frame with the scene drawn over it by the camera: the solids tinted and with bright outlines, liquids blue,
// bodies orange; the edges of the domain grey; the axes at the scene's origin red, green, blue; a silhouette's outline
// white. InputError for a frame of another size than the camera's pictures.
Image draw_overlay(const CameraRecord& camera, const std::filesystem::path& frame, const SceneOverlay& overlay);

// The board as it was found in a picture, with its axes from the first point.
Image draw_board_axes(const std::filesystem::path& path, const Board& board, const BoardView& view);

} // namespace treacle::video
