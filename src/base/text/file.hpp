#pragma once
#include <filesystem>
#include <string>

namespace treacle {

// Durability of a file: it must be on the disk when its writer returns, or may be lost with the machine's power.
enum class Durability { synced, cached };

// Replaces a file as a whole: writes a temporary name beside it, syncs, renames.
// Throws SimulationError when the disk is full or the folder cannot be written; the old file then stands.
void write_file_atomically(
    const std::filesystem::path& path, const std::string& content, Durability durability = Durability::synced);

// The content of a file; empty when it cannot be read.
std::string read_file(const std::filesystem::path& path);

// Size of all files in a folder and below [bytes]; 0 when it is not there.
double folder_bytes(const std::filesystem::path& folder);

// Syncs a finished temporary file to disk and gives it its final name (for writers that stream).
void sync_and_rename(const std::filesystem::path& temporary, const std::filesystem::path& path);

} // namespace treacle
