#pragma once
#include "surface/mesh/components.hpp"

namespace treacle::surface {

// Values at the vertices of a patch, on the device.
struct VertexValues {
    Array<double> normal, velocity; // [vertices * 3]
    Array<double> pressure;         // [vertices]
    Array<int> liquid;              // [vertices]
    Array<double> scalar;           // [scalars][vertices]
    int scalars = 0;                // numbers per vertex
};

// Triangles of the patch that the mesh has.
struct KeptPatch {
    const HostPatch& patch;
    const std::vector<char>& kept; // [triangles of the patch] 0: dropped
};

// Collective: the kept triangles of this rank and their vertices, numbered over all ranks: each rank's own vertices follow
// those of the ranks before it; the numbers of others' vertices come from their owners.
void number_mesh(
    const Comm& comm, const KeptPatch& kept, const VertexOwners& owners, const VertexValues& values, Mesh& mesh);

// Area of this rank's triangles [m2], in 2D length of its segments [m].
double area_of(const Mesh& mesh);

} // namespace treacle::surface
