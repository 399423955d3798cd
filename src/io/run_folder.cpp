#include "io/run_folder.hpp"

#include "base/text/error.hpp"

#include <algorithm>
#include <regex>
#include <unistd.h>

namespace treacle::io {

namespace {
void add_matching(
    const std::filesystem::path& folder, const std::string& pattern, std::vector<std::filesystem::path>& files) {
    const std::regex names(pattern);
    std::error_code missing;
    for (const auto& item : std::filesystem::directory_iterator(folder, missing))
        if (!item.is_directory() && std::regex_match(item.path().filename().string(), names))
            files.push_back(item.path());
}

[[noreturn]] void refuse(
    const std::filesystem::path& path, const std::string& problem, const std::string& reason, const std::string& cure) {
    throw InputError(Diagnostic{path.string(), problem, reason, cure});
}

// Everything that can go wrong is checked before anything is changed.
void check_writable(const std::filesystem::path& path) {
    auto parent = std::filesystem::absolute(path);
    while (!std::filesystem::exists(parent)) parent = parent.parent_path();
    if (!std::filesystem::is_directory(parent))
        refuse(path, "the output folder cannot be made", parent.string() + " is a file",
            "choose another folder with --out");
    if (::access(parent.c_str(), W_OK | X_OK) != 0)
        refuse(path, "the output folder cannot be written", "no permission in " + parent.string(),
            "choose another folder with --out");
}

// A lock that a killed run left behind is no result.
bool is_used(const std::filesystem::path& root) {
    if (!std::filesystem::exists(root)) return false;
    for (const auto& item : std::filesystem::directory_iterator(root))
        if (item.path().filename() != FolderLock::file_name) return true;
    return false;
}

void refuse_used(const std::filesystem::path& root, ExistingFiles existing) {
    if (existing == ExistingFiles::overwrite || !is_used(root)) return;
    refuse(root, "the output folder exists and is not empty", "a run does not mix its files with those of another",
        "choose another folder with --out, or replace the files of the run in it with --overwrite");
}

void prepare(RunFolder& folder, ExistingFiles existing) {
    check_writable(folder.root);
    for (const auto& part : {folder.frames(), folder.checkpoints()})
        if (std::filesystem::exists(part) && !std::filesystem::is_directory(part))
            refuse(part, "this is a file", "a run makes a folder of this name", "move it away");
    refuse_used(folder.root, existing);
    std::filesystem::create_directories(folder.root);
    folder.lock = std::make_shared<const FolderLock>(folder.root);
    refuse_used(folder.root, existing); // another run may have begun and ended since
    for (const auto& file : files_of_run(folder)) std::filesystem::remove(file);
    std::filesystem::create_directories(folder.frames());
    std::filesystem::create_directories(folder.checkpoints());
}
} // namespace

std::vector<std::filesystem::path> files_of_run(const RunFolder& folder) {
    std::vector<std::filesystem::path> files;
    add_matching(folder.root,
        "((effective\\.yaml|manifest\\.json|summary\\.json|steps\\.csv|measurements\\.csv|bodies\\.csv|"
        "lost_particles\\.csv)(\\.tmp)?|STOP)",
        files);
    add_matching(folder.frames(), ".*(_[0-9]{6,}\\.hdf|\\.hdf\\.series)(\\.tmp)?", files);
    add_matching(folder.checkpoints(), "checkpoint_[0-9]{9,}\\.h5(\\.tmp)?", files);
    std::sort(files.begin(), files.end());
    return files;
}

RunFolder prepare_run_folder(const Comm& comm, const std::filesystem::path& path, ExistingFiles existing) {
    RunFolder folder{path.lexically_normal()};
    comm.guard_root([&] {
        try {
            prepare(folder, existing);
        } catch (const std::filesystem::filesystem_error& error) {
            refuse(path, "the output folder cannot be prepared", error.code().message(),
                "choose another folder with --out");
        }
    });
    return folder;
}

RunFolder open_run_folder(const Comm& comm, const std::filesystem::path& path, Access access) {
    RunFolder folder{path.lexically_normal()};
    comm.guard_root([&] {
        if (!std::filesystem::is_directory(folder.root))
            refuse(path, "there is no such folder", "", "give the folder that a run wrote");
        if (!std::filesystem::exists(folder.effective_scene()))
            refuse(path, "this is not the folder of a run", "it holds no effective.yaml",
                "give the folder that a run wrote");
        if (access == Access::write) folder.lock = std::make_shared<const FolderLock>(folder.root);
    });
    return folder;
}

} // namespace treacle::io
