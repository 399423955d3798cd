#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace treacle::surface {

// This rank's part of a closed, oriented surface of the liquid: triangles seen counter-clockwise from outside; in 2D
// segments with the liquid on their left. Every rank lists the vertices of its own triangles: first those that it owns,
// then those that a neighbouring rank owns. Ranks without triangles have none.
struct Mesh {
    int dimensions = 3;
    std::vector<double> vertices;              // [n][3] [m]
    std::vector<double> normals;               // [n][3] unit, outward
    std::vector<double> velocity;              // [n][3] [m/s]
    std::vector<double> pressure;              // [n] [Pa]
    std::vector<int> liquid;                   // [n] index of the scene's liquid
    std::vector<std::vector<double>> scalars;  // [Options::scalars][n]
    std::vector<std::int64_t> key;             // [n] place on the lattice (LatticeKey of doubled node numbers)
    std::vector<std::int64_t> global;          // [n] number among the vertices of all ranks
    std::vector<std::array<int, 3>> triangles; // [m][3] rows of this rank's vertices; 2D: [m][2], the third is -1
    std::int64_t owned = 0;                    // vertices of this rank: global = first_vertex + row
    std::int64_t first_vertex = 0, first_triangle = 0;
    std::int64_t total_vertices = 0, total_triangles = 0; // of all ranks

    // Vertices, those of other ranks included.
    std::int64_t size() const { return static_cast<std::int64_t>(vertices.size() / 3); }
};

// Figures of a surface, the same on every rank.
struct Summary {
    double volume = 0;           // [m3], 2D [m2]
    double area = 0;             // [m2], 2D [m]
    std::int64_t components = 0; // closed surfaces that are kept, cavities among them
    std::int64_t dropped = 0;    // closed surfaces left out for their size
    double dropped_volume = 0;   // [m3], 2D [m2] that they enclose; cavities count as negative
    std::int64_t particles = 0;  // that the surface was made from
};

} // namespace treacle::surface
