#pragma once
#include "scene/scene.hpp"
#include "surface/mesh/mesh.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace treacle::surface {

// Adds the mirror image of each vertex and triangle of this rank, for each plane in turn: n planes make 2^n parts. For drawing: each part is closed by
// itself, and keys, numbers among all ranks and totals stay those of the first.
void add_images(Mesh& mesh, const std::vector<scene::MirrorPlane>& planes);

// The same for rows [n][3]: `twice_position` is twice the plane's position for points [m], and 0 of vectors; and for rows of any other kind.
void add_image(std::vector<double>& rows, std::size_t axis, double twice_position);
template <class T>
void add_image(std::vector<T>& rows) {
    const auto size = rows.size();
    rows.resize(2 * size);
    std::copy_n(rows.begin(), size, rows.begin() + std::ptrdiff_t(size));
}

// The one of the images of x [m] that is in the part of the scene that is run.
Vec3 folded(Vec3 x, const scene::Domain& domain);

} // namespace treacle::surface
