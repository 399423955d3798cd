#pragma once
#include "scene/camera/camera_model.hpp"
#include "video/film/film_look.hpp"
#include "video/mask/mask.hpp"

#include <array>
#include <functional>
#include <span>
#include <vector>

namespace treacle::video {

// A closed surface of liquid at one time, with its motion.
struct FilmMesh {
    int dimensions = 3;
    std::span<const double> position, normal, velocity; // [n][3] [m], unit, [m/s]
    std::span<const std::array<int, 3>> triangles;      // 2D: segments with the liquid on their left, the third is -1
};

// Exposure, sampling and material of one frame.
struct FilmShot {
    double offset = 0;   // of the middle of the exposure from the mesh's time [s]
    double exposure = 0; // [s]; vertices move along straight lines in it
    double readout = 0;  // from the first to the last row of a rolling shutter [s]; the middle row is at `offset`
    int instants = 1;    // of the exposure, odd: the middle one makes the mask
    int samples = 3;     // along the edge of a pixel, odd: the middle one is the pixel's centre
    std::array<double, 3> colour{0.05, 0.04, 0.03}; // of the liquid under full light
    double gloss = 0.1;                             // light of highlights
};

// Obstacles between camera and liquid, in pixels: depth [height][width] [m], 1e30 where nothing is.
using FilmDepth = std::vector<float>;

// Liquid of one frame, before the look of the camera.
struct FilmDrawing {
    FilmLight light; // light of the liquid by its share of each pixel, averaged over the instants and samples
    Mask mask;       // pixels whose centre is liquid at the middle of the exposure, not hidden
    FilmDepth depth; // of the liquid at the centres of the mask's pixels, 1e30 beside them
};

// Draws triangles with a depth buffer, by scene::TriangleRaster, seen at the time of their row: without `hidden` the mask is
// the silhouette of src/surface, bit for bit.
FilmDrawing draw_liquid(
    const FilmMesh& mesh, const scene::CameraModel& camera, const FilmShot& shot, const FilmDepth& hidden);

// Solids by the distance from them: spheres are traced along the rays of pixel centres (Hart 1996), from `near` to `far` [m].
struct FilmScenery {
    FilmLight light;
    FilmDepth depth;
};
FilmScenery draw_solids(
    const scene::CameraModel& camera, const std::function<double(const Vec3&)>& distance, double far);

} // namespace treacle::video
