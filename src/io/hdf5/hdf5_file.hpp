#pragma once
#include "io/hdf5/hdf5_handle.hpp"

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

// Inside of the folder only: this header shows HDF5.
namespace treacle::io {

// Type in the file: that of the values, or float32 for doubles.
enum class Stored { as_given, float32 };
// The format of the metadata: the widest readable one, or the one in which HDF5 checks its metadata by sums.
enum class Metadata { widely_readable, checked };

// [rows * components].
using Values = std::variant<std::span<const double>, std::span<const std::int64_t>, std::span<const std::int32_t>,
    std::span<const std::uint8_t>>;

// This rank's rows of one dataset, [rows][components]; rows of all ranks follow each other in rank order.
struct Dataset {
    std::string path;
    Values values;
    int components = 1;
    Stored stored = Stored::as_given;
};

// Input of write_hdf5(); ranks differ in their rows alone.
struct FilePlan {
    std::filesystem::path path;                    // of the finished file
    std::vector<Dataset> datasets;                 // the same paths in the same order on every rank
    Metadata metadata = Metadata::widely_readable; // the same on every rank
    // On rank 0, when all datasets exist: groups, attributes.
    std::function<void(hid_t file)> describe;
};

// Collective: writes one file as a whole; on failure the temporary is removed, an older file of that name
// stands, and every rank throws.
// Rank 0 makes the file alone, with the space of every dataset, so that no collective call ever changes
// metadata; the disk space is reserved before any rank writes, so that a full disk is detected by rank 0 in a
// plain system call and not by one rank in the middle of a collective one.
void write_hdf5(const Comm& comm, const FilePlan& plan);

// Rows of this rank.
std::int64_t row_count(const Dataset& dataset);

} // namespace treacle::io
