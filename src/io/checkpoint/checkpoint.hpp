#pragma once
#include "mpi/comm.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace treacle::io {

// Types in the file: any other number becomes one of them.
using AttributeValue = std::variant<double, std::int64_t, std::string>;

// Writes one checkpoint: all state in double precision, HDF5, one file. Three kinds of state: attributes
// (single values), replicated arrays (the same on every rank; rank 0's are written), distributed arrays
// (rows of all ranks after each other). Names may contain slashes: "liquid/position". Every array carries a
// checksum. Nothing is on disk before commit(), and nothing of an unfinished one stays there.
class CheckpointWriter {
public:
    // path: see checkpoint_path. Its folder is made by commit() when it is missing.
    CheckpointWriter(const Comm& comm, const std::filesystem::path& path);
    ~CheckpointWriter();

    // Each name once; the same calls in the same order on every rank. Throws std::logic_error for a name
    // given twice.
    void attribute(const std::string& name, const AttributeValue& value);
    // The values must live until commit().
    void replicated(const std::string& name, std::span<const double> values);
    void replicated(const std::string& name, std::span<const std::int64_t> values);
    // This rank's rows, [rows][components]. The values must live until commit(); a vector that is moved in is
    // kept instead.
    void distributed(const std::string& name, int components, std::span<const double> values);
    void distributed(const std::string& name, int components, std::span<const std::int64_t> values);
    void distributed(const std::string& name, int components, std::vector<double>&& values);
    void distributed(const std::string& name, int components, std::vector<std::int64_t>&& values);

    // Collective: writes a temporary file, syncs and renames it. Throws SimulationError on every rank when it
    // cannot; the temporary is then gone and older checkpoints stand.
    void commit();

private:
    struct State;
    std::unique_ptr<State> state_;
};

// This rank's rows of a distributed array.
template <class T>
struct Rows {
    int components = 1;
    std::int64_t total = 0; // rows of all ranks
    std::vector<T> values;  // [rows][components]
    std::int64_t size() const { return static_cast<std::int64_t>(values.size()) / components; }
};

// Reads a checkpoint on any number of ranks. T is double or std::int64_t. Every checksum is verified by the
// read. InputError for a name that is not there, or for another type.
class CheckpointReader {
public:
    // Collective. Throws InputError on every rank when the file is no checkpoint or damaged.
    CheckpointReader(const Comm& comm, const std::filesystem::path& path);
    ~CheckpointReader();
    CheckpointReader(CheckpointReader&&) noexcept;

    // Contents, read by the constructor and known on every rank; lists are sorted by name.
    int writer_ranks() const;
    bool has_attribute(const std::string& name) const;
    bool has_distributed(const std::string& name) const;
    bool has_replicated(const std::string& name) const;
    std::vector<std::string> distributed_names() const;
    std::vector<std::string> attribute_names() const;
    AttributeValue attribute(const std::string& name) const;
    // T: double, std::int64_t, std::string.
    template <class T>
    T attribute(const std::string& name) const;
    // The same on every rank.
    template <class T>
    std::vector<T> replicated(const std::string& name) const;
    // Rows of all ranks, without reading them.
    std::int64_t total_rows(const std::string& name) const;
    // Collective: on as many ranks as the writer's the rows that this rank wrote, otherwise an equal share in
    // the order of the file. Arrays with the same rows are cut alike. Throws InputError on every rank when
    // the checksum is wrong.
    template <class T>
    Rows<T> distributed(const std::string& name) const;
    // Collective: reads an array for its checksum alone. Throws InputError as distributed() does.
    void verify(const std::string& name) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

// Collective: empty when the checkpoint is whole, otherwise the reason why it is not, on every rank. Reads
// all of it.
std::string validate_checkpoint(const Comm& comm, const std::filesystem::path& path);

// FOLDER/checkpoint_000000123.h5
std::filesystem::path checkpoint_path(const std::filesystem::path& folder, std::int64_t step);
// The checkpoints of a folder by step, newest first; none for a folder that is missing.
std::vector<std::filesystem::path> list_checkpoints(const std::filesystem::path& folder);

// Result of newest_valid_checkpoint(), the same on every rank.
struct NewestCheckpoint {
    std::optional<std::filesystem::path> path; // nothing: none is whole
    std::vector<std::string> skipped;          // a message for each newer one that is broken
};
// Collective.
NewestCheckpoint newest_valid_checkpoint(const Comm& comm, const std::filesystem::path& folder);
// Collective: removes all but the newest count (at least 1) and temporaries that a killed run left.
void keep_last_checkpoints(const Comm& comm, const std::filesystem::path& folder, int count);
// Collective: removes the checkpoints past a step, when a run goes on from an earlier one.
void remove_checkpoints_after(const Comm& comm, const std::filesystem::path& folder, std::int64_t step);

} // namespace treacle::io
