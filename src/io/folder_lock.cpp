#include "io/folder_lock.hpp"

#include "base/text/error.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace treacle::io {

namespace {
std::string owner() {
    char name[256] = {};
    const bool known = ::gethostname(name, sizeof name - 1) == 0;
    return std::string(known ? name : "unknown") + ", process " + std::to_string(::getpid()) + "\n";
}

std::string content(int file) {
    char text[512] = {};
    const auto size = ::pread(file, text, sizeof text - 1, 0);
    std::string out(text, size > 0 ? static_cast<std::size_t>(size) : 0);
    while (!out.empty() && out.back() == '\n') out.pop_back();
    return out;
}

// True while the file that is open still stands under its path: a program that ends removes it.
bool still_there(int file, const std::filesystem::path& path) {
    struct stat opened {
    }, named{};
    return ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
           opened.st_dev == named.st_dev;
}
} // namespace

// True when the file was locked before its last owner removed it.
bool FolderLock::take(const std::filesystem::path& folder) {
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file_ < 0)
        throw InputError({folder.string(), "the output folder cannot be written", std::strerror(errno),
            "choose another folder with --out"});
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EWOULDBLOCK) {
            const auto who = content(file_);
            ::close(file_);
            throw InputError({folder.string(), "a run is writing into this folder",
                who.empty() ? "two runs would mix their files" : "it is on " + who,
                "wait until it has ended, stop it with a file STOP in the folder, or choose another folder"});
        }
        warning_ = folder.string() + ": nothing keeps a second run out of this folder; the file system has no locks (" +
                   std::strerror(errno) + ")";
    }
    if (still_there(file_, path_)) return true;
    ::close(file_);
    return false;
}

FolderLock::FolderLock(const std::filesystem::path& folder) : path_(folder / file_name) {
    while (!take(folder)) {
    }
    // For messages alone: a full disk is found by what follows.
    const auto text = owner();
    if (::ftruncate(file_, 0) == 0 && ::pwrite(file_, text.data(), text.size(), 0) < 0) errno = 0;
}

FolderLock::~FolderLock() {
    ::unlink(path_.c_str());
    ::close(file_);
}

} // namespace treacle::io
