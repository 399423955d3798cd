#pragma once
#include "base/log.hpp"
#include "io/folder_lock.hpp"
#include "study/journal.hpp"
#include "study/lanes.hpp"

#include <functional>
#include <map>
#include <memory>
#include <span>

namespace treacle::study {

// A key of a scene that is set, and the place that asks for it: "study.yaml:12: viscosity".
struct Assignment {
    std::string text; // "liquids.syrup.viscosity=12 Pa.s"
    std::string origin;
};

// What a study needs to know of a scene; the program's own reader of scenes tells it. Throws InputError where the scene is
// not valid with these assignments.
struct SceneFacts {
    std::string content; // all that a run's result depends on: every value, and the contents of the files that it names
    double end = 0;      // [s] of simulated time
    double work = 0;     // in which its runs' lengths are to each other, roughly: particles times steps; 0: not known
};
using SceneReader = std::function<SceneFacts(const std::filesystem::path& scene, const std::vector<Assignment>& assignments)>;

// The keys that a run of the study sets in its scene: those of the scene's entry, measured values, parameters.
std::vector<Assignment> assignments_of(const Study& study, const StudyScene& scene, const Point& values);

// Hash of all that a run's result depends on: the scene's content, ranks, and the program's version and sources.
std::string run_key(const SceneFacts& facts, int ranks, const std::string& program);
JournalOwner owner_of(const Study& study, const std::string& program);
// Version and sources of this program, in one line.
std::string program_identity();

// A run that may be asked for.
struct Candidate {
    std::string scene; // its name
    Point values;
    std::string key;
    double end = 0;  // [s] of simulated time
    double work = 0; // as in SceneFacts
};
// Throws InputError when the scene refuses the values.
Candidate candidate_of(const Study& study, const StudyScene& scene, const Point& values, const SceneReader& read_scene);
// Of every point in every scene, the scenes of a point side by side. Throws InputError with what is wrong in all of them.
std::vector<Candidate> candidates_of(const Study& study, const std::vector<Point>& points, const SceneReader& read_scene);

// Runs at once: those of the study, or as many as the cores of this machine are enough for.
int lane_count(const RunOptions& options);

// Throws InputError when the program in front of each run is not there.
void check_launcher(const Study& study);

struct StudySetup {
    std::filesystem::path folder;  // of the study's results
    std::filesystem::path program; // the executable, absolute
    std::function<void()> changed; // called once a second at most, when runs have ended; may be empty
};

enum class StudyEnd { complete, stopped };

// The runs of a study: asked for by values, done once each on lanes, remembered in the journal.
class StudyRuns {
public:
    // Makes the folder, and takes it for itself. Throws InputError when another program holds it, and for a journal of
    // another study.
    StudyRuns(const Study& study, StudySetup setup, Log& log);

    // The number of this run: that of the same run asked for before, or the next one.
    std::int64_t ask(const Candidate& candidate);
    // Does those of the runs that have no outcome yet, on all lanes, in their order. Failed ones stay so, unless they are to
    // be retried. Outcomes are the same on any number of lanes. Throws InputError for a figure that a run's tables do not
    // have; the runs that are done stay so.
    StudyEnd run(std::span<const std::int64_t> runs, bool retry_failed = false);

    // For those who do the runs themselves: the runs without an outcome, each once, in their order; the folder and request of
    // one; and its outcome, from how it ended and its folder, into the journal.
    std::vector<std::int64_t> waiting(std::span<const std::int64_t> runs, bool retry_failed);
    // In the order in which lanes do them best: the longest first, so that none of them stands alone at the end (Graham 1969).
    std::vector<std::int64_t> longest_first(std::vector<std::int64_t> runs) const;
    void write_request(std::int64_t number) const;
    void finish(const LaneResult& result);

    const Journal& journal() const { return journal_; }
    const Study& study() const { return study_; }
    std::filesystem::path run_folder(std::int64_t number) const; // with the request and the result
    int lanes() const { return lane_count_; }

private:
    RunOutcome settle(const LaneResult& result) const;
    bool adopt_finished(std::int64_t number); // from its folder, or another study's
    void start(std::int64_t number, Lanes& lanes) const;
    void tidy(std::int64_t number) const;
    void read_again(std::int64_t number); // where the study reads other figures than before
    void report(std::span<const std::int64_t> runs, std::size_t fresh, Lanes& lanes);
    void check_disk() const;

    const Study& study_;
    StudySetup setup_;
    Log& log_;
    io::FolderLock lock_;
    Journal journal_;
    std::vector<std::pair<std::filesystem::path, Journal>> others_; // studies whose runs count
    std::string program_;
    int lane_count_;
    bool changed_ = false; // runs have ended since the last report
    double simulated_end_ = 0; // [s], of the last run that was asked for
    std::map<std::int64_t, double> work_; // of the runs asked for
    std::chrono::steady_clock::time_point start_, last_report_;
};

} // namespace treacle::study
