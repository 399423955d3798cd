#pragma once
#include "io/value.hpp"
#include "mpi/comm.hpp"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace treacle::io {

// Program and libraries that a result is made with.
struct BuildInfo {
    std::string version;  // of the program
    std::string commit;   // of its sources; "unknown" outside of a repository
    std::string state;    // of its sources: "clean", "modified", "unknown"
    std::string compiler; // name and version
    std::string flags;
    std::string type; // "Release"
};
BuildInfo build_info();

using Versions = std::vector<std::pair<std::string, std::string>>; // name, version
// The libraries of this folder: HDF5 (as loaded) and MPI (as compiled against).
Versions library_versions();

// 64-bit FNV-1a of a text as 16 hexadecimal digits: distinguishes scenes, no protection against intent.
std::string text_hash(const std::string& text);

// Name of this machine; "unknown" where it has none.
std::string host_name();

// Entries of manifest.json that write_manifest() takes from elsewhere.
struct Manifest {
    std::vector<std::string> command; // the command line
    std::string input;                // path of the scene
    std::string input_text;           // the scene in effect, of which the hash is taken
    Versions libraries;               // of other folders; those of library_versions() are added
    Value extra;                      // further entries (an object), or null
};

// Collective: writes manifest.json with version, sources, compiler, libraries, ranks, hosts, start time (UTC)
// and hash of the input. Throws SimulationError.
void write_manifest(const Comm& comm, const std::filesystem::path& path, const Manifest& manifest);

// A run that goes on from a checkpoint.
struct Resumption {
    std::vector<std::string> command;
    std::int64_t step = 0;            // of the checkpoint
    std::string input_text;           // the scene in effect from here on
    std::vector<std::string> changes; // of the scene: "time.end=20 s"
};

// Collective: adds to the list "resumed" of manifest.json when, on how many ranks, from which step and with what changes,
// and brings "input hash" up to date. A manifest that is missing or damaged is begun anew. Throws SimulationError.
void add_resumption(const Comm& comm, const std::filesystem::path& path, const Resumption& resumption);

// Collective: rank 0 writes the object, e.g. summary.json. Throws SimulationError on every rank.
void write_summary(const Comm& comm, const std::filesystem::path& path, const Value& summary);

} // namespace treacle::io
