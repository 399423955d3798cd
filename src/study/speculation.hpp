#pragma once
#include "study/candidates.hpp"
#include "study/lanes/lanes.hpp"

#include <deque>
#include <map>
#include <set>

namespace treacle::study {

// Runs that may be requested later, done on lanes that would idle. A finished one lies in FOLDER/KEY until a run of its
// key is requested. No journal and no table contains them, so that a study's answer is the same with them and without.
class Speculation {
public:
    Speculation(const Study& study, std::filesystem::path folder) : study_(study), folder_(std::move(folder)) {}

    // The likeliest first; those offered before that have not been started are removed.
    void offer(std::vector<Candidate> candidates);
    bool is_idle() const { return offered_.empty() && running_.empty(); }

    // The next one that is not done yet, its request written, with a negative number; nothing when there is none. The command is
    // the caller's.
    std::optional<LaneTask> next(const Journal& journal);
    // The last of those under way that is no more offered. Its lane may be taken for one that is.
    std::optional<std::int64_t> stale() const;
    // The one started last of those under way without a request. Its lane may be taken for a requested run.
    std::optional<std::int64_t> least_wanted() const;
    // True when a run of this key is under way; it is then kept to its end for the request.
    bool claim(const std::string& key);
    // The run on this lane task has ended, or was ended: its key, and true when it was requested. Unless it has a
    // result, its folder is removed.
    struct Ended {
        std::string key;
        bool claimed = false;
    };
    Ended ended(std::int64_t number);
    // Moves a finished run to the folder of the run that was requested; false when there is none.
    bool take(const std::string& key, const std::filesystem::path& folder) const;
    double bytes() const; // on disk

private:
    struct Running {
        std::string key;
        bool offered = true, claimed = false;
    };
    bool is_under_way(const std::string& key) const;

    const Study& study_;
    std::filesystem::path folder_;
    std::deque<Candidate> offered_;
    std::map<std::int64_t, Running> running_; // by the number of the lane's task: the last one started first
    std::set<std::string> tried_;             // keys that were started; what failed is not started again
    std::int64_t last_ = 0;
};

} // namespace treacle::study
