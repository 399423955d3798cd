#pragma once
#include "mpi/comm.hpp"
#include "surface/mesh/mesh.hpp"

#include <cstdint>

namespace treacle::surface {

// Faults of a surface; all zero for a closed, oriented manifold. The same on every rank.
struct MeshFaults {
    std::int64_t open = 0; // edges (2D: vertices) with a triangle on one side only
    std::int64_t crowded =
        0; // directed edges of more than one triangle: more than two at an edge, or turned against each other
    std::int64_t pinched = 0; // vertices at which the surface touches itself: more than one fan of triangles
    std::int64_t flat = 0;    // triangles with a corner twice or without area
    bool none() const { return open == 0 && crowded == 0 && pinched == 0 && flat == 0; }
};

// Collective: checks every edge and vertex of the mesh of all ranks; each rank is sent the fans of some of the
// vertices.
MeshFaults check_mesh(const Comm& comm, const Mesh& mesh);

} // namespace treacle::surface
