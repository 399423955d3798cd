#pragma once
#include "app/render/frame_set.hpp"
#include "app/render/scene_surface.hpp"
#include "video/drawing/liquid_view.hpp"

#include <optional>
#include <string>

namespace treacle::app {

// The field that stands for the liquids' own colours.
inline constexpr const char* no_field = "none";

// A frame's liquid in the camera's picture.
struct LiquidPicture {
    video::LiquidView view;
    double time = 0;                            // [s]
    std::int64_t total = 0;                     // particles
    surface::Solids solids;                     // where they are
    std::string title;                          // of the values
    bool has_lower = false, has_higher = false; // values beyond the range
};

// Draws the liquid's surfaces of a run: every rank draws the triangles of its own part of the mesh, and one of them gets
// what it takes to make the picture: the nearest of each sample, never the mesh.
class LiquidPainter {
public:
    // Collective. `field`: see scalar_names, or no_field. Throws InputError. The run must stay.
    LiquidPainter(const Comm& comm, const RunView& run, const video::LiquidScene& scene, const std::string& field);

    // Collective: the picture of a frame, on rank `to` alone.
    std::optional<LiquidPicture> draw(std::size_t frame, int to);

private:
    Comm comm_;
    video::LiquidScene scene_;
    SceneSurface surface_;
};

} // namespace treacle::app
