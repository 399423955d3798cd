#pragma once
#include "io/frame.hpp"

#include <filesystem>
#include <string>

namespace treacle::io {

// ply: binary little endian, one vertex a particle, components as name_x name_y name_z. vtp: XML PolyData of
// vertices, binary. csv: a header with units, one line a particle.
enum class ExportFormat { ply, vtp, csv };

// "ply", "vtp", "csv". Throws InputError for another one; obj is refused because it has neither velocities
// nor any other field of a particle.
ExportFormat export_format(const std::string& name);
// "ply" etc., also the extension of the file.
std::string format_name(ExportFormat format);

// Writes the particles of a frame with all fields, velocity among them; reals in the frame's own precision.
// On this rank alone. The file appears as a whole or not at all. Throws SimulationError when it cannot be
// written and InputError when the format cannot hold a value (ply has no integers beyond 32 bits; those up to
// 2^53 become doubles).
void export_particles(const std::filesystem::path& path, const Frame& frame, ExportFormat format);

} // namespace treacle::io
