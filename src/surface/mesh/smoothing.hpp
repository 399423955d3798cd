#pragma once
#include "surface/mesh/triangulation.hpp"

namespace treacle::surface {

// (SM2) Smooths the vertices of a patch by Taubin's pairs of steps (1995), x += lambda L x and x += mu L x with mu < 0, which
// keep the volume where a single step would shrink it. L x is the mean of the neighbours less x. Vertices on faces at
// which the surface is cut stay on them: those on their rim move with their neighbours on the rim, others not at all.
// Each step makes one more layer of vertices at the patch's border differ from the neighbours'.
class Smoothing {
public:
    void smooth(Patch& patch, int passes);
    // Unit normals of the vertices, from the triangles around them by area; in 2D from segments by length. [vertices * 3]
    const Array<double>& normals(const Patch& patch);

    // Kernels (public for nvcc).
    void link(const Patch& patch);
    void step(const Patch& patch, double factor);

private:
    Array<int> offsets_{"treacle::star_offsets", 0}, stars_{"treacle::stars", 0}; // triangles around a vertex
    Array<double> next_{"treacle::smoothed", 0}, normal_{"treacle::vertex_normals", 0};
};

} // namespace treacle::surface
