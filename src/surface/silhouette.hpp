#pragma once
#include "mpi/comm.hpp"
#include "scene/camera/triangle_raster.hpp"
#include "surface/mesh/mesh.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace treacle::surface {

using scene::Exposure;

// Triangles of solids, which hide the liquid behind them.
struct HidingTriangles {
    std::vector<double> vertices;              // [n][3] [m]
    std::vector<std::array<int, 3>> triangles; // [m][3]
};

// (SI1) The liquid in a camera's picture: a pixel is covered when its centre lies in a projected triangle, on an edge
// only when that is a top or left one, and no solid is nearer there. The same bits on any number of ranks.
struct Silhouette {
    int width = 0, height = 0;
    std::vector<std::uint8_t> mask; // [height][width] 1: liquid
    std::vector<double> depth;      // [height][width] [m] along the camera's axis; 1e300 without liquid
    std::int64_t count() const;     // covered pixels
};

// Collective: each rank draws its own triangles; the nearest of all ranks counts. `solids` is the same on every rank.
// Triangles are split until the projections of their edges are within `straightness` pixels of straight lines.
// InputError for a mesh in 2D.
Silhouette draw_silhouette(const Comm& comm, const Mesh& mesh, const scene::CameraModel& camera,
    const Exposure& exposure = {}, const HidingTriangles* solids = nullptr, double straightness = 0.05);

// Pixels in one mask and not in the other. Both have the same size.
std::int64_t mismatches(const Silhouette& a, const Silhouette& b);

// (SI2) Collective: signed distance [pixels] of pixel centres to the liquid's outline, positive in it, up to `band`; beyond it
// +-band. The outline is that of the mesh, not of the pixels: edges between a triangle that faces the camera and one that
// does not, beside which there is no liquid. It changes smoothly where the mask jumps by whole pixels.
std::vector<float> outline_distance(const Comm& comm, const Mesh& mesh, const scene::CameraModel& camera,
    const Silhouette& silhouette, const Exposure& exposure = {}, double band = 3);

} // namespace treacle::surface
