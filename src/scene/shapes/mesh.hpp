#pragma once
#include "scene/shapes/bounds.hpp"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace treacle::scene {

// A closed surface of triangles, counter-clockwise seen from outside.
struct TriangleMesh {
    std::vector<Vec3> vertices;                // [m]
    std::vector<std::array<int, 3>> triangles; // indices into vertices
};

// Report of what was found, and done, when a mesh was put in order.
struct MeshReport {
    std::string path;
    std::size_t vertices = 0, triangles = 0;
    std::size_t welded = 0;       // vertices merged with another one
    std::size_t degenerate = 0;   // triangles without area that were left out
    std::size_t open_edges = 0;   // edges with an odd number of triangles
    std::size_t holes = 0;        // loops of open edges
    std::size_t shared_edges = 0; // edges with more than two triangles
    std::size_t wall_edges = 0;   // of the open ones those with more than two triangles, where a wall meets the surface
    std::size_t duplicates = 0;   // triangles that another one repeats, facing the same way
    std::size_t turned = 0;       // triangles turned round to agree with their neighbours
    bool inside_out = false;      // all triangles faced inwards and were turned round
    std::size_t components = 0;   // connected parts
    Bounds bounds;                // [m]
    double volume = 0;            // [m3]
    double separate_volume = 0;   // [m3] of parts that overlap their sum, once `volume` is that of their union; else 0
    double buried = 0;            // share of the area that lies inside of other parts
    double inwards = 0;           // share of the area that faces inwards, outside of all other parts
    double area = 0;              // [m2]
    double thickness_p01 = 0;     // [m] 1 % of the area (of rays from it, inwards) is thinner than this
    bool closed() const { return open_edges == 0; }
    // Beyond the creases of scans, which are of no volume.
    bool overlaps() const { return buried > 2e-3; }
    // One sentence per thing that was changed; empty when the file was fine.
    std::vector<std::string> notes() const;
};

// Mesh as check_mesh() leaves it, with its report.
struct CheckedMesh {
    TriangleMesh mesh; // [m], or the file's unit before it is scaled
    MeshReport report; // of `mesh`
};

// The triangles of a file (PLY, OBJ, STL and what else Assimp reads), in the file's units, as they are. Coordinates are read in
// single precision. InputError when the file cannot be read, or holds no triangle, a non-finite coordinate, or coordinates
// that are rounded by more than 1e-4 of the mesh's size, as those of maps are.
TriangleMesh read_mesh(const std::string& path, const std::string& where);

// Welds equal vertices (to 1e-9 of the size), drops triangles without area, turns triangles so that
// neighbours agree and the volume is positive, and measures the result. Throws nothing for a mesh with holes.
CheckedMesh check_mesh(TriangleMesh mesh);

// The connected parts.
std::vector<CheckedMesh> split(const CheckedMesh& checked);

// read_mesh + check_mesh; InputError for a mesh that is not closed, has duplicate triangles, inner walls or parts that face
// inwards, or encloses no volume.
CheckedMesh load_closed_mesh(const std::string& path, const std::string& where);

} // namespace treacle::scene
