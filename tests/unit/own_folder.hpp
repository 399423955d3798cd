#pragma once
#include <cstdlib>
#include <filesystem>
#include <string>

namespace treacle::test {

// A folder of this test alone, removed with all that is in it at the end of the test.
class OwnFolder {
public:
    OwnFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "treacle_").string() + std::string(6, 'X');
        if (mkdtemp(name.data()) == nullptr) std::abort();
        path_ = name;
    }
    OwnFolder(const OwnFolder&) = delete;
    OwnFolder& operator=(const OwnFolder&) = delete;
    ~OwnFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

} // namespace treacle::test
