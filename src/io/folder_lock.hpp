#pragma once
#include <filesystem>
#include <string>

namespace treacle::io {

// Keeps a folder for the one program that writes into it: a lock on the file run.lock, which the operating system lifts
// when the process ends, whatever ends it. Of one process; other ranks hold none.
class FolderLock {
public:
    // Throws InputError when another program holds the folder, with its host and process, or when the file cannot be
    // made.
    explicit FolderLock(const std::filesystem::path& folder);
    // Removes the file.
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

    // Why nothing keeps others out, where the file system has no locks; empty otherwise.
    const std::string& warning() const { return warning_; }

    static constexpr const char* file_name = "run.lock"; // holds host and process

private:
    bool take(const std::filesystem::path& folder);

    std::filesystem::path path_;
    int file_ = -1;
    std::string warning_;
};

} // namespace treacle::io
