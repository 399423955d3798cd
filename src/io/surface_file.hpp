#pragma once
#include "mpi/comm.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace treacle::io {

// ply: binary little endian. obj: text; it has no place for velocities. vtp: XML PolyData, binary.
enum class SurfaceFormat { ply, obj, vtp };

// "ply", "obj", "vtp". Throws InputError for another one.
SurfaceFormat surface_format(const std::string& name);
std::string format_name(SurfaceFormat format);

// A quantity of the vertices.
struct SurfaceField {
    std::string name, unit;
    int components = 1;                 // 1 or 3
    std::span<const double> reals;      // [n][components]
    std::span<const int> integers = {}; // [n] in the place of reals
    bool whole = false;                 // whether they are
};

// This rank's part of a surface: its own vertices, and its triangles by the numbers of vertices over all ranks.
struct SurfacePart {
    int dimensions = 3;               // 2: a polyline
    double time = 0;                  // [s]
    std::span<const double> vertices; // [n][3] [m]
    std::span<const double> normals;  // [n][3], if there are any
    std::vector<SurfaceField> fields; // the same on every rank
    bool has_normals = true;
    std::vector<std::array<std::int64_t, 3>> triangles; // [m][3]; 2D: [m][2], the third is -1
};

// Collective: one file, written by all ranks side by side; obj leaves the fields out. Reals are float32. Throws SimulationError when it cannot be
// written and InputError for more than 2^31 - 1 vertices in ply.
void write_surface(const Comm& comm, const std::filesystem::path& path, const SurfacePart& part, SurfaceFormat format);

} // namespace treacle::io
