#pragma once

#include <filesystem>

namespace treacle::app {

// Treatment of a folder that is there and holds something: an error, or its removal by `finish`.
enum class ExistingFolder { refuse, replace };

// A folder that is filled under a temporary name and gets its own when all of it is there; gone without `finish`.
class FolderUnderWay {
public:
    // InputError when the folder exists, holds something and may not be replaced.
    FolderUnderWay(const std::filesystem::path& folder, ExistingFolder existing);
    ~FolderUnderWay();
    FolderUnderWay(const FolderUnderWay&) = delete;
    FolderUnderWay& operator=(const FolderUnderWay&) = delete;

    const std::filesystem::path& path() const { return temporary_; } // the temporary name, beside the final one
    void finish(); // replaces the folder; SimulationError when it cannot

private:
    std::filesystem::path folder_, temporary_;
    bool finished_ = false;
};

} // namespace treacle::app
