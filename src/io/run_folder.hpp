#pragma once
#include "io/folder_lock.hpp"
#include "mpi/comm.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace treacle::io {

// Treatment of a folder that is not empty.
enum class ExistingFiles { refuse, overwrite };

// Purpose for which a folder of results is opened.
enum class Access { read, write };

// Folder of the results of a run.
struct RunFolder {
    std::filesystem::path root;
    // Lock of rank 0, for writing: keeps other runs out as long as this or a copy of it lives.
    std::shared_ptr<const FolderLock> lock{};

    // Paths of what a run writes, there or not.
    std::filesystem::path effective_scene() const { return root / "effective.yaml"; }
    std::filesystem::path manifest() const { return root / "manifest.json"; }
    std::filesystem::path summary() const { return root / "summary.json"; }
    std::filesystem::path steps() const { return root / "steps.csv"; }
    std::filesystem::path measurements() const { return root / "measurements.csv"; }
    std::filesystem::path bodies() const { return root / "bodies.csv"; }
    std::filesystem::path lost_particles() const { return root / "lost_particles.csv"; }
    std::filesystem::path frames() const { return root / "frames"; }
    std::filesystem::path checkpoints() const { return root / "checkpoints"; }
    // A file of this name stops the run.
    std::filesystem::path stop() const { return root / "STOP"; }
};

// Collective: makes the folder with frames/ and checkpoints/ in it. Throws InputError on every rank when the
// path is a file, when the folder is not empty and existing files are refused, when another program writes into it, or
// when it cannot be made; nothing is changed then. Overwriting removes the files that a run makes, by name, and no other file.
RunFolder prepare_run_folder(const Comm& comm, const std::filesystem::path& path, ExistingFiles existing);

// Collective: the folder of a run to read or, with Access::write, to go on with. Throws InputError on every rank when
// it is missing or holds no effective.yaml, and for writing when another program writes into it.
RunFolder open_run_folder(const Comm& comm, const std::filesystem::path& path, Access access = Access::read);

// The files that overwriting would remove, sorted; on this rank alone.
std::vector<std::filesystem::path> files_of_run(const RunFolder& folder);

} // namespace treacle::io
