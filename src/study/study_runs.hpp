#pragma once
#include "base/text/log.hpp"
#include "io/folder_lock.hpp"
#include "study/candidates.hpp"
#include "study/lanes/journal.hpp"
#include "study/lanes/lanes.hpp"
#include "study/speculation.hpp"

#include <functional>
#include <map>
#include <memory>
#include <span>

namespace treacle::study {

// Runs at once: those of the study, or as many as the cores of this machine are enough for.
int lane_count(const RunOptions& options);

// Throws InputError when the program in front of each run is not there.
void check_launcher(const Study& study);

// Places of a study's files, and a call while it runs.
struct StudySetup {
    std::filesystem::path folder;  // of the study's results
    std::filesystem::path program; // the executable, absolute
    std::function<void()> changed; // called once a second at most, when runs have ended; may be empty
};

// End of StudyRuns::run(): all runs have an outcome, or a stop was asked for.
enum class StudyEnd { complete, stopped };

// The runs of a study: requested by values, done once each on lanes, recorded in the journal.
class StudyRuns {
public:
    // Makes the folder, and locks it. Throws InputError when another program holds it, and for a journal of
    // another study.
    StudyRuns(const Study& study, StudySetup setup, Log& log);

    // The number of this run: that of an earlier request of the same run, or the next one. Its cut holds until the next
    // request: a run that stopped early at a bound which is not above it is done again.
    std::int64_t ask(const Candidate& candidate);
    // Does those of the runs that have no outcome yet, on all lanes, in their order. Failed ones stay so, unless they are to
    // be retried. Outcomes are the same on any number of lanes. Throws InputError for a figure that a run's tables do not
    // have; the runs that are done stay so.
    StudyEnd run(std::span<const std::int64_t> runs, bool retry_failed = false);

    // Candidates that may be requested later, the likeliest first: work for idle lanes while `run` blocks. They
    // change no outcome. Those offered before are removed; without any, what is under way is ended.
    void offer(std::vector<Candidate> candidates);

    // For those who do the runs themselves: the runs without an outcome, each once, in their order; the folder and request of
    // one; and its outcome, from how it ended and its folder, into the journal.
    std::vector<std::int64_t> waiting(std::span<const std::int64_t> runs, bool retry_failed);
    // In the order in which lanes do them best: the longest first, so that none of them stands alone at the end (Graham 1969).
    std::vector<std::int64_t> longest_first(std::vector<std::int64_t> runs) const;
    void write_request(std::int64_t number) const;
    void finish(const LaneResult& result);
    // Once a second at most: status.json and the progress of these runs, of which `fresh` had no outcome at first and some are
    // under way on as many lanes; and the setup's `changed` when runs have ended.
    void report(std::span<const std::int64_t> runs, std::size_t fresh, std::vector<LaneProgress> under_way, int lanes);

    const Journal& journal() const { return journal_; }          // all runs so far
    const Study& study() const { return study_; }                // of the constructor
    std::filesystem::path run_folder(std::int64_t number) const; // with the request and the result
    std::filesystem::path folder_of(
        std::int64_t number) const;           // likewise, be it that of another study which has done it
    int lanes() const { return lane_count_; } // runs at once

private:
    RunOutcome settle(const LaneResult& result) const;
    double cut(std::int64_t number) const;
    bool is_answered(std::int64_t number, bool retry_failed) const;
    bool adopt_finished(std::int64_t number); // from its folder, or another study's
    Lanes& open_lanes();
    void start(LaneTask task);
    void fill_lanes(std::deque<std::int64_t>& queue, std::set<std::int64_t>& under_way);
    void take(
        const std::vector<LaneResult>& results, std::deque<std::int64_t>& queue, std::set<std::int64_t>& under_way);
    void give_up(std::int64_t speculative);
    const RunRequest& request(std::int64_t number) const { return journal_.runs()[std::size_t(number - 1)]; }
    void tidy(const std::filesystem::path& folder) const;
    void read_again(std::int64_t number); // where the study reads other figures than before
    void check_disk() const;
    void check_space(const RunOutcome& outcome) const;

    const Study& study_;
    StudySetup setup_;
    Log& log_;
    io::FolderLock lock_;
    Journal journal_;
    std::vector<std::pair<std::filesystem::path, Journal>> others_; // studies whose runs count
    int lane_count_;
    Speculation speculation_;
    std::unique_ptr<Lanes> lanes_;        // while runs are done, and as long as there is something to speculate about
    bool changed_ = false;                // runs have ended since the last report
    double simulated_end_ = 0;            // [s], of the last requested run
    std::map<std::int64_t, double> work_; // of the requested runs
    std::map<std::int64_t, double> cuts_; // of those requested last, where they have one
    std::chrono::steady_clock::time_point start_, last_report_;
};

} // namespace treacle::study
