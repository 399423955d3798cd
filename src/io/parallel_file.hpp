#pragma once
#include "mpi/comm.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace treacle::io {

// This rank's bytes of one stretch of a file. Those of all ranks follow each other in rank order.
struct Stretch {
    std::vector<char> bytes;

    // Appends the value's bytes in this machine's order.
    template <class T>
    void put(T value) {
        const auto* from = reinterpret_cast<const char*>(&value);
        bytes.insert(bytes.end(), from, from + sizeof value);
    }
    void put(const std::string& text) { bytes.insert(bytes.end(), text.begin(), text.end()); } // without an end mark
};

// Collective: writes a file of stretches, one behind the other, each rank its own part of each; nothing is gathered. The
// file appears as a whole or not at all. Throws SimulationError on every rank when it cannot be written.
void write_parallel(const Comm& comm, const std::filesystem::path& path, const std::vector<Stretch>& stretches);

} // namespace treacle::io
