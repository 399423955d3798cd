#include "io/parallel_file.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace treacle::io {

namespace {
[[noreturn]] void fail(const std::filesystem::path& path, const std::string& verb) {
    throw SimulationError({path.string(), "cannot " + verb + " this file", std::strerror(errno),
        "free some space or choose another folder with --out"});
}

void write_all(int file, const std::filesystem::path& path, const std::vector<char>& bytes, std::int64_t at) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const auto n = ::pwrite(file, bytes.data() + done, bytes.size() - done, at + static_cast<std::int64_t>(done));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) fail(path, "write");
        done += static_cast<std::size_t>(n);
    }
}
} // namespace

void write_parallel(const Comm& comm, const std::filesystem::path& path, const std::vector<Stretch>& stretches) {
    std::vector<std::int64_t> at;
    std::int64_t first = 0;
    for (const auto& stretch : stretches) {
        const auto size = static_cast<std::int64_t>(stretch.bytes.size());
        at.push_back(first + comm.exclusive_sum(size));
        first += comm.sum(size);
    }
    auto temporary = path;
    temporary += ".tmp";
    int file = -1;
    try {
        comm.guard_root([&] {
            const int made = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
            if (made < 0) fail(path, "create");
            // The disk's space is reserved before any rank writes.
            const int status = first > 0 ? ::posix_fallocate(made, 0, first) : 0;
            ::close(made);
            errno = status;
            if (status != 0) fail(path, "write");
        });
        comm.guard([&] {
            file = ::open(temporary.c_str(), O_WRONLY);
            if (file < 0) fail(path, "open");
            for (std::size_t k = 0; k < stretches.size(); ++k) write_all(file, path, stretches[k].bytes, at[k]);
            if (::fsync(file) != 0) fail(path, "sync");
        });
        comm.guard_root([&] { sync_and_rename(temporary, path); });
    } catch (...) {
        if (file >= 0) ::close(file);
        if (comm.is_root()) ::unlink(temporary.c_str());
        throw;
    }
    ::close(file);
}

} // namespace treacle::io
