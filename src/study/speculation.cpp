#include "study/speculation.hpp"

#include "study/lanes/forward_files.hpp"

#include <algorithm>

namespace treacle::study {

void Speculation::offer(std::vector<Candidate> candidates) {
    for (auto& running : running_) {
        auto& run = running.second;
        run.offered = std::ranges::any_of(candidates, [&](const Candidate& one) { return one.key == run.key; });
    }
    offered_.assign(std::make_move_iterator(candidates.begin()), std::make_move_iterator(candidates.end()));
}

bool Speculation::is_under_way(const std::string& key) const {
    return std::ranges::any_of(running_, [&](const auto& entry) { return entry.second.key == key; });
}

std::optional<LaneTask> Speculation::next(const Journal& journal) {
    for (; !offered_.empty(); offered_.pop_front()) {
        const auto& one = offered_.front();
        const auto* asked = journal.find(one.key);
        const auto folder = folder_ / one.key;
        if (asked || tried_.contains(one.key) || is_under_way(one.key) || read_result(folder, one.key)) continue;
        std::filesystem::remove_all(folder);
        write_request(folder, request_of(study_, {0, one.scene, one.values, one.key, one.changes}), Durability::cached);
        tried_.insert(one.key);
        running_[--last_] = {one.key};
        offered_.pop_front();
        LaneTask task;
        task.number = last_;
        task.folder = folder;
        task.oom_score = expendable_oom_score;
        return task;
    }
    return {};
}

std::optional<std::int64_t> Speculation::stale() const {
    if (offered_.empty()) return {};
    const auto found = std::ranges::find_if(
        running_, [](const auto& entry) { return !entry.second.offered && !entry.second.claimed; });
    return found == running_.end() ? std::nullopt : std::optional(found->first);
}

std::optional<std::int64_t> Speculation::least_wanted() const {
    const auto found = std::ranges::find_if(running_, [](const auto& entry) { return !entry.second.claimed; });
    return found == running_.end() ? std::nullopt : std::optional(found->first);
}

bool Speculation::claim(const std::string& key) {
    for (auto& running : running_) {
        auto& run = running.second;
        if (run.key == key) return run.claimed = true;
    }
    return false;
}

Speculation::Ended Speculation::ended(std::int64_t number) {
    const auto run = running_.at(number);
    running_.erase(number);
    if (!read_result(folder_ / run.key, run.key)) std::filesystem::remove_all(folder_ / run.key);
    return {run.key, run.claimed};
}

bool Speculation::take(const std::string& key, const std::filesystem::path& folder) const {
    if (is_under_way(key) || !read_result(folder_ / key, key)) return false;
    std::filesystem::remove_all(folder);
    std::filesystem::rename(folder_ / key, folder);
    return true;
}

double Speculation::bytes() const { return folder_bytes(folder_); }

} // namespace treacle::study
