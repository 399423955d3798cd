#pragma once
#include "../own_folder.hpp"
#include "mpi/comm.hpp"

#include <optional>

// A folder that all ranks share, gone at the end of the test.
class TemporaryFolder {
public:
    explicit TemporaryFolder(const treacle::Comm& comm) : comm_(comm) {
        if (comm.is_root()) folder_.emplace();
        path_ = comm.broadcast(folder_ ? folder_->path().string() : "");
    }
    ~TemporaryFolder() { comm_.barrier(); }
    const std::filesystem::path& path() const { return path_; }
    operator const std::filesystem::path&() const { return path_; }

private:
    treacle::Comm comm_;
    std::optional<treacle::test::OwnFolder> folder_; // of the root
    std::filesystem::path path_;
};

// Runs work; returns the text of its error, empty when there is none. All ranks get the same.
template <class Work>
std::string error_of(Work&& work) {
    try {
        work();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "";
}
