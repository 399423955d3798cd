#pragma once
#include "mpi/comm.hpp"

#include <cstdlib>
#include <filesystem>
#include <string>

// A folder that all ranks share, gone at the end of the test.
class TemporaryFolder {
public:
    explicit TemporaryFolder(const treacle::Comm& comm) : comm_(comm) {
        std::string name = (std::filesystem::temp_directory_path() / "treacle_io_XXXXXX").string();
        if (comm.is_root() && !mkdtemp(name.data())) std::abort();
        path_ = comm.broadcast(name);
    }
    ~TemporaryFolder() {
        comm_.barrier();
        std::error_code ignored;
        if (comm_.is_root()) std::filesystem::remove_all(path_, ignored);
    }
    const std::filesystem::path& path() const { return path_; }
    operator const std::filesystem::path&() const { return path_; }

private:
    treacle::Comm comm_;
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
