#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace treacle::io {

// An array of numbers of a MATLAB 7.3 file, which is HDF5: [rows][columns] in the file's order, MATLAB's transposed.
struct MatArray {
    std::int64_t rows = 0;
    int columns = 1;
    std::vector<double> values; // [rows][columns]
};

// True when the file is HDF5, after a header of up to some kilobytes as MATLAB writes it.
bool is_hdf5(const std::filesystem::path& path);

// The numeric arrays at the root of the file by their names; cells, structures and texts are left out. Of one process, needs no
// MPI. Throws InputError for a file that cannot be read.
std::map<std::string, MatArray> read_mat(const std::filesystem::path& path);

} // namespace treacle::io
