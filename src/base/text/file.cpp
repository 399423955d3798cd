#include "base/text/file.hpp"

#include "base/text/error.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace treacle {

namespace {
[[noreturn]] void fail(const std::filesystem::path& path, const std::string& verb) {
    throw SimulationError(
        {path.string(), "cannot " + verb, std::strerror(errno), "free some space or choose another folder with --out"});
}

void sync_path(const std::filesystem::path& path, int flags) {
    const int file = ::open(path.c_str(), flags);
    if (file < 0) fail(path, "open");
    const int status = ::fsync(file);
    ::close(file);
    if (status != 0) fail(path, "sync");
}

void rename_to(const std::filesystem::path& temporary, const std::filesystem::path& path) {
    if (::rename(temporary.c_str(), path.c_str()) != 0) fail(path, "rename to");
}
} // namespace

std::string read_file(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

double folder_bytes(const std::filesystem::path& folder) {
    std::error_code ignored;
    double sum = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, ignored)) {
        const auto size = entry.is_regular_file(ignored) ? entry.file_size(ignored) : 0;
        if (!ignored) sum += double(size);
    }
    return sum;
}

void sync_and_rename(const std::filesystem::path& temporary, const std::filesystem::path& path) {
    sync_path(temporary, O_RDONLY);
    rename_to(temporary, path);
    const auto folder = path.parent_path();
    sync_path(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
}

namespace {

[[noreturn]] void abandon(int file, const std::filesystem::path& temporary, const std::filesystem::path& path) {
    const int saved = errno;
    ::close(file);
    ::unlink(temporary.c_str());
    errno = saved;
    fail(path, "write");
}

} // namespace

void write_file_atomically(const std::filesystem::path& path, const std::string& content, Durability durability) {
    auto temporary = path;
    temporary += ".tmp";
    const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (file < 0) fail(temporary, "create");
    std::size_t done = 0;
    while (done < content.size()) {
        const ssize_t n = ::write(file, content.data() + done, content.size() - done);
        if (n < 0) abandon(file, temporary, path);
        done += static_cast<std::size_t>(n);
    }
    ::close(file);
    if (durability == Durability::cached) return rename_to(temporary, path);
    sync_and_rename(temporary, path);
}

} // namespace treacle
