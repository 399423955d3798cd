#pragma once
#include "app/render/picture.hpp"
#include "app/setup/geometry.hpp"
#include "scene/sampling/sampling.hpp"

namespace treacle::app {

// The particles of a scene at its start, coarser than in the run where there would be more than a million.
struct Preview {
    scene::Lattice lattice; // that the particles lie on
    double coarsening = 1;  // its spacing over the scene's
    scene::VolumeSamples liquid;
    DrawnSolids solids;
    std::uint64_t liquid_count = 0, solid_count = 0; // of the run: counted unless coarser, else estimated
    std::size_t thin_solid = 0;                      // samples of bodies thinner than the layer lies deep
};
Preview make_preview(const Input& input, const Geometry& geometry);

// The scene's first camera, or a view of the whole domain.
video::Image draw_preview(const Input& input, const Preview& preview);

// Share of each liquid's particles that are in no cube (square) of three particles a side: the liquid there
// is thinner than three spacings. Empty when the preview is coarser than the run.
std::vector<double> thin_fractions(const Preview& preview, std::size_t liquids);

} // namespace treacle::app
