#pragma once

#include <filesystem>

namespace treacle::app {

enum class ExistingFolder { refuse, replace };

// A folder that is filled under a temporary name and gets its own when all of it is there; gone without `finish`.
class FolderUnderWay {
public:
    // InputError when the folder exists, holds something and may not be replaced.
    FolderUnderWay(const std::filesystem::path& folder, ExistingFolder existing);
    ~FolderUnderWay();
    FolderUnderWay(const FolderUnderWay&) = delete;
    FolderUnderWay& operator=(const FolderUnderWay&) = delete;

    const std::filesystem::path& path() const { return temporary_; }
    void finish();

private:
    std::filesystem::path folder_, temporary_;
    bool finished_ = false;
};

} // namespace treacle::app
