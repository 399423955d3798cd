#include "app/input/folder_under_way.hpp"

#include "base/text/error.hpp"

#include <cstdlib>
#include <unistd.h>

namespace treacle::app {

namespace fs = std::filesystem;

FolderUnderWay::FolderUnderWay(const fs::path& folder, ExistingFolder existing) : folder_(folder) {
    if (folder_.filename().empty()) folder_ = folder_.parent_path(); // DIR/
    std::error_code error;
    const bool filled = fs::exists(folder_) && !(fs::is_directory(folder_) && fs::is_empty(folder_, error));
    if (filled && existing == ExistingFolder::refuse)
        throw InputError({folder_.string(), "exists and is not empty",
            "results of an earlier call would be mixed with these", "choose another --out, or give --overwrite"});
    temporary_ = folder_;
    temporary_ += ".part" + std::to_string(::getpid());
    fs::create_directories(temporary_, error);
    if (error)
        throw SimulationError({temporary_.string(), "cannot be created", error.message(), "choose another --out"});
}

FolderUnderWay::~FolderUnderWay() {
    std::error_code ignored; // nothing is left to be done about a folder that is gone
    if (!finished_) fs::remove_all(temporary_, ignored);
}

void FolderUnderWay::finish() {
    std::error_code error;
    fs::remove_all(folder_, error);
    if (!error) fs::rename(temporary_, folder_, error);
    if (error) throw SimulationError({folder_.string(), "cannot be replaced", error.message(), "choose another --out"});
    finished_ = true;
}

} // namespace treacle::app
