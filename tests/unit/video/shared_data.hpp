#pragma once
#include <cstdlib>
#include <filesystem>

namespace treacle::test {

// Folder of data that was measured elsewhere and is not part of the project: TREACLE_SHARED_DATA, or ../shared/data
// beside it. Empty where there is none: the test skips.
inline std::filesystem::path shared_data(const char* folder) {
    const char* variable = std::getenv("TREACLE_SHARED_DATA");
    const std::filesystem::path root = variable ? variable : TREACLE_SOURCE "/../shared/data";
    return std::filesystem::exists(root / folder) ? root / folder : std::filesystem::path();
}

} // namespace treacle::test
