#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace treacle::io {

// A table of one process: columns of numbers and of texts, all of one length, by their names with units.
struct TableFile {
    std::vector<std::pair<std::string, std::vector<double>>> numbers;
    std::vector<std::pair<std::string, std::vector<std::string>>> texts;
};

// An HDF5 file with a dataset a column, in the order of the columns; '/' in names becomes " per ". Replaced as a whole; needs
// no MPI. Throws SimulationError.
void write_table_file(const std::filesystem::path& path, const TableFile& table);

} // namespace treacle::io
