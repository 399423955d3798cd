#pragma once
#include "mpi/decomposition.hpp"
#include "surface/mesh/mesh.hpp"
#include "surface/mesh/triangulation.hpp"

namespace treacle::surface {

// The patch where host code reads it.
struct HostPatch {
    int vertices = 0, triangles = 0, per = 3; // corners of a triangle
    std::vector<double> position;             // [vertices * 3] [m]
    std::vector<std::int64_t> key;
    std::vector<int> corner, own;
};
HostPatch to_host(const Patch& patch);

// Rank that owns a vertex: that of the cell above the node from which its edge goes out.
class VertexOwners {
public:
    VertexOwners(const Decomposition& decomposition, const Lattice& lattice);
    int owner(std::int64_t key) const;

private:
    const Decomposition& decomposition_;
    const Lattice& lattice_;
    std::vector<int> near_; // ranks whose boxes touch this rank's
};

// Collective: closed surfaces of all ranks together, by the vertices that they share. Those that enclose less than
// `min_volume` spacings^dimensions are to be dropped: kept[t] of this rank's own triangles is 0 then. Volumes are sums of
// whole numbers, the same on any number of ranks. Fills the summary.
std::vector<char> find_components(const Comm& comm, const HostPatch& patch, const VertexOwners& owners, double spacing,
    double min_volume, Summary& summary);

} // namespace treacle::surface
