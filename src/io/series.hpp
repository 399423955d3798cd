#pragma once
#include "io/frame.hpp"

namespace treacle::io {

// Replaces the index NAME.hdf.series as a whole, in ParaView's format 1.0. Throws SimulationError.
void write_series(const std::filesystem::path& path, const std::vector<SeriesEntry>& entries);

inline constexpr const char* series_suffix = ".hdf.series";

} // namespace treacle::io
