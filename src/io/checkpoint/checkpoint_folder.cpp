#include "io/checkpoint/checkpoint.hpp"

#include <algorithm>
#include <cstdio>
#include <regex>

namespace treacle::io {

namespace {
const std::regex checkpoint_name("checkpoint_([0-9]{9,18})\\.h5");
const std::regex temporary_name("checkpoint_[0-9]{9,18}\\.h5\\.tmp");

std::vector<std::filesystem::path> files_like(const std::filesystem::path& folder, const std::regex& pattern) {
    std::vector<std::filesystem::path> files;
    std::error_code missing;
    for (const auto& item : std::filesystem::directory_iterator(folder, missing))
        if (std::regex_match(item.path().filename().string(), pattern)) files.push_back(item.path());
    return files;
}

std::int64_t step_of(const std::filesystem::path& path) {
    const auto name = path.filename().string();
    std::smatch match;
    return std::regex_match(name, match, checkpoint_name) ? std::stoll(match[1]) : -1;
}
} // namespace

std::filesystem::path checkpoint_path(const std::filesystem::path& folder, std::int64_t step) {
    char name[64];
    std::snprintf(name, sizeof name, "checkpoint_%09lld.h5", static_cast<long long>(step));
    return folder / name;
}

std::vector<std::filesystem::path> list_checkpoints(const std::filesystem::path& folder) {
    auto files = files_like(folder, checkpoint_name);
    std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return step_of(a) > step_of(b); });
    return files;
}

NewestCheckpoint newest_valid_checkpoint(const Comm& comm, const std::filesystem::path& folder) {
    std::vector<std::int64_t> steps; // only rank 0 reads the folder, so that all ranks have the same list
    comm.guard_root([&] {
        for (const auto& path : list_checkpoints(folder)) steps.push_back(step_of(path));
    });
    NewestCheckpoint newest;
    for (const auto step : comm.all_gather(std::span<const std::int64_t>(steps))) {
        const auto path = checkpoint_path(folder, step);
        const auto reason = validate_checkpoint(comm, path);
        if (reason.empty()) {
            newest.path = path;
            return newest;
        }
        newest.skipped.push_back("skipped " + path.filename().string() + ": " + reason);
    }
    return newest;
}

void keep_last_checkpoints(const Comm& comm, const std::filesystem::path& folder, int count) {
    comm.guard_root([&] {
        const auto files = list_checkpoints(folder);
        for (std::size_t i = static_cast<std::size_t>(std::max(count, 1)); i < files.size(); ++i)
            std::filesystem::remove(files[i]);
        for (const auto& file : files_like(folder, temporary_name)) std::filesystem::remove(file);
    });
}

void remove_checkpoints_after(const Comm& comm, const std::filesystem::path& folder, std::int64_t step) {
    comm.guard_root([&] {
        for (const auto& file : list_checkpoints(folder))
            if (step_of(file) > step) std::filesystem::remove(file);
    });
}

} // namespace treacle::io
