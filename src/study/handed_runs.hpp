#pragma once
#include "study/lanes/journal.hpp"
#include "study/model/study.hpp"

#include <span>

namespace treacle::study {

// Runs that others do: job arrays, Dakota, people. Each has a folder DIR/0007 with its request (forward_files.hpp), where
// `treacle forward` leaves its result.

// Writes the folders of the next runs without an outcome, `count` of them at most, that have none there yet; of those that
// failed as well where they are to be retried. Returns their numbers.
std::vector<std::int64_t> hand_out(const Study& study, const Journal& journal, std::span<const std::int64_t> runs,
    int count, const std::filesystem::path& folder, bool retry_failed);

// Numbers of folders that take_in() found.
struct TakenIn {
    int done = 0, failed = 0;      // new outcomes
    int known = 0;                 // had the same outcome before
    int open = 0;                  // written as requests, and not done yet
    std::vector<std::string> left; // folders that were left alone, each with the reason
};
// Takes the results in the folders into the journal, in the order of their numbers. A result that comes after its run was
// counted as failed counts; a failure after a result does not. Folders of other studies, without a request, or with files
// that are not whole are left alone.
TakenIn take_in(const Study& study, Journal& journal, const std::filesystem::path& folder);

} // namespace treacle::study
